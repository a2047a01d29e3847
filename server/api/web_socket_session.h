#pragma once

#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <memory>

#include "server/api/connections.h"
#include "server/api/service.h"

namespace cairn::server {

/// Answers the upgrade `request` and serves the WebSocket until it ends. The stream's executor is a
/// strand; the session owns itself and its `place`.
void run_web_socket_session(boost::beast::tcp_stream stream,
                            boost::beast::http::request<boost::beast::http::empty_body> request,
                            Service& service, std::unique_ptr<Connections::Place> place);

}  // namespace cairn::server
