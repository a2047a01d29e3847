#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

/// The written bounds of the API: what one peer, or all of them, can make the server hold.
namespace cairn::server {

inline constexpr std::size_t kMaxConnections = 64;  ///< HTTP and WebSocket together.
inline constexpr std::uint32_t kMaxHeaderBytes = 8 * 1024;
inline constexpr std::size_t kMaxHttpBodyBytes = 0;       ///< Only GET is answered.
inline constexpr std::chrono::seconds kHttpTimeout{15};   ///< For a request, and for its answer.
inline constexpr std::chrono::seconds kIdleTimeout{60};   ///< WebSocket without a sign of life.
inline constexpr std::chrono::seconds kWriteTimeout{10};  ///< One message to a slow reader.
inline constexpr std::size_t kMaxOpenRequests = 16;       ///< Per WebSocket; then it is not read.
inline constexpr std::size_t kMaxMapTransfers = 2;        ///< Per WebSocket.

}  // namespace cairn::server
