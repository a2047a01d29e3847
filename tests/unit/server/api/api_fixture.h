#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "fake_service.h"
#include "server/api/api_server.h"

namespace cairn::server {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
using net::ip::tcp;
using nlohmann::json;
using testing::HasSubstr;

/// The server on a free port of the loopback, run by two threads.
class ApiTest : public testing::Test {
 protected:
  ApiTest() : server_(ApiServer::start(io_, {"127.0.0.1", 0}, service_).value()) {
    for (int i = 0; i < 2; ++i) threads_.emplace_back([this] { io_.run(); });
  }
  ~ApiTest() override {
    service_.release();
    server_.reset();
    work_.reset();
    for (auto& thread : threads_) thread.join();
  }

  tcp::socket connect() {
    tcp::socket socket(client_io_);
    socket.connect({net::ip::make_address("127.0.0.1"), server_->port()});
    const timeval patience{10, 0};
    ::setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    return socket;
  }

  /// Waits until something that other threads bring about is true.
  template <class Condition>
  static bool eventually(Condition condition) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > until) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }

  FakeService service_;
  net::io_context io_;
  net::executor_work_guard<net::io_context::executor_type> work_{io_.get_executor()};
  std::unique_ptr<ApiServer> server_;
  net::io_context client_io_;
  std::vector<std::thread> threads_;
};

}  // namespace cairn::server
