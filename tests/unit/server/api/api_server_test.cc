#include "server/api/api_server.h"

#include "api_fixture.h"
#include "server/api/limits.h"

namespace cairn::server {
namespace {

TEST_F(ApiTest, SaysWhichPortIsInUseAndWhatToDo) {
  const auto port = server_->port();
  const auto second = ApiServer::start(io_, {"127.0.0.1", port}, service_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::conflict);
  EXPECT_EQ(second.error().message, "port " + std::to_string(port) +
                                        " on 127.0.0.1 is in use: stop the other program or "
                                        "choose --port");
}

TEST_F(ApiTest, RefusesAnAddressThatIsNone) {
  const auto server = ApiServer::start(io_, {"localhorst", 0}, service_);
  ASSERT_FALSE(server);
  EXPECT_EQ(server.error().code, ErrorCode::invalid_argument);
}

TEST_F(ApiTest, ClosesItsPortAndConnectionsWhenStopped) {
  auto socket = connect();
  server_->stop();
  std::array<char, 1> byte{};
  beast::error_code fault;
  socket.read_some(net::buffer(byte), fault);
  EXPECT_TRUE(fault == net::error::eof || fault == net::error::connection_reset) << fault.message();
}

TEST_F(ApiTest, TurnsAwayConnectionsBeyondTheBoundAndServesAgainWhenOneLeaves) {
  std::vector<tcp::socket> held;
  for (std::size_t i = 0; i < kMaxConnections; ++i) held.push_back(connect());
  std::array<char, 1> byte{};
  beast::error_code fault;
  auto extra = connect();
  extra.read_some(net::buffer(byte), fault);
  EXPECT_TRUE(fault == net::error::eof || fault == net::error::connection_reset) << fault.message();

  held.pop_back();
  EXPECT_TRUE(eventually([this] {
    auto socket = connect();
    beast::error_code lost;
    http::request<http::empty_body> request(http::verb::get, "/healthz", 11);
    http::write(socket, request, lost);
    beast::flat_buffer buffer;
    http::response<http::string_body> response;
    if (!lost) http::read(socket, buffer, response, lost);
    return !lost && response.body() == "ok\n";
  }));
}

}  // namespace
}  // namespace cairn::server
