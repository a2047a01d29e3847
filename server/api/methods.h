#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/common/result.h"
#include "server/api/service.h"

namespace cairn::server {

/// Carries out the methods that are one question and one answer: status, found, goto, stop, plan.
/// `reply` is called exactly once, on any thread. Returns false, without a call, for other methods.
[[nodiscard]] bool call_method(Service& service, const std::string& method,
                               const nlohmann::json& params,
                               std::function<void(Result<nlohmann::json>)> reply);

}  // namespace cairn::server
