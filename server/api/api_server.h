#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "core/common/result.h"
#include "server/api/service.h"

namespace cairn::server {

struct ApiConfig {
  std::string address = "127.0.0.1";  ///< IP address to listen on; 0.0.0.0 or :: for all.
  std::uint16_t port = 8642;          ///< 0: any free one.
};

/// The operators' door: HTTP and WebSocket on one TCP port (API.md). `io` may be run by several
/// threads; each connection lives on a strand of its own.
class ApiServer {
 public:
  /// Listens from now on. conflict: the port is in use; invalid_argument: no such address here.
  /// Requires: `io` and `service` outlive the server, and `service` every handler that `io` runs.
  static Result<std::unique_ptr<ApiServer>> start(boost::asio::io_context& io,
                                                  const ApiConfig& config, Service& service);
  ~ApiServer();
  ApiServer(const ApiServer&) = delete;
  ApiServer& operator=(const ApiServer&) = delete;

  /// Closes the port and all connections; answers that are still to come are dropped. Thread-safe.
  void stop();
  [[nodiscard]] std::uint16_t port() const;

 private:
  class Listener;
  explicit ApiServer(std::shared_ptr<Listener> listener);

  std::shared_ptr<Listener> listener_;
};

}  // namespace cairn::server
