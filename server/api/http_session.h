#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>

#include "server/api/connections.h"
#include "server/api/service.h"

namespace cairn::server {

/// Serves HTTP on a fresh connection until it ends or becomes a WebSocket. The socket's executor
/// is a strand; the session owns itself and its `place`.
void run_http_session(boost::asio::ip::tcp::socket socket, Service& service,
                      std::shared_ptr<Connections> connections,
                      std::unique_ptr<Connections::Place> place);

}  // namespace cairn::server
