#pragma once

#include <cstdint>
#include <string>

#include "proto/json/messages.h"

namespace cairn::server {

/// The API's own state, for its metrics.
struct ApiCounts {
  std::size_t connections = 0;
  std::uint64_t refused = 0;  ///< Connections beyond the bound since the start.
};

/// Prometheus' text format, version 0.0.4.
[[nodiscard]] std::string metrics_text(const api::StatusReply& status, const ApiCounts& counts);

}  // namespace cairn::server
