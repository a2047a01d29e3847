#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/common/result.h"
#include "server/api/connections.h"
#include "server/api/service.h"

namespace cairn::server {

inline constexpr std::string_view kWebSocketTarget = "/api/v1/ws";

struct HttpAnswer {
  int code = 200;
  std::string content_type;
  std::string body;
};

[[nodiscard]] HttpAnswer json_answer(int http_code, ErrorCode code, const std::string& message);

/// Answers a GET of `target`; `reply` is called exactly once, on any thread.
void respond(Service& service, const Connections& connections, const std::string& target,
             std::function<void(HttpAnswer)> reply);

}  // namespace cairn::server
