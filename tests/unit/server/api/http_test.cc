#include "api_fixture.h"
#include "proto/codec/tile_snapshot.h"
#include "server/api/limits.h"

namespace cairn::server {
namespace {

class HttpTest : public ApiTest {
 protected:
  using Response = http::response<http::string_body>;

  Response ask(http::request<http::string_body> request) {
    auto socket = connect();
    request.set(http::field::host, "127.0.0.1");
    request.prepare_payload();
    beast::error_code fault;
    http::write(socket, request, fault);
    beast::flat_buffer buffer;
    Response response;
    http::read(socket, buffer, response, fault);
    EXPECT_FALSE(fault) << fault.message();
    return response;
  }
  Response get(const std::string& target) { return ask({http::verb::get, target, 11}); }
};

TEST_F(HttpTest, SaysThatItIsHealthy) {
  const auto response = get("/healthz");
  EXPECT_EQ(response.result_int(), 200U);
  EXPECT_EQ(response.body(), "ok\n");
}

TEST_F(HttpTest, GivesTheStatusAsJson) {
  const auto response = get("/api/v1/status");
  EXPECT_EQ(response[http::field::content_type], "application/json");
  EXPECT_EQ(json::parse(response.body())["version"], "0.1.0");
}

TEST_F(HttpTest, GivesMetricsForPrometheus) {
  const auto response = get("/metrics");
  EXPECT_EQ(response.result_int(), 200U);
  EXPECT_THAT(response.body(), HasSubstr("\ncairn_api_connections 1\n"));
}

TEST_F(HttpTest, GivesTheBytesOfATile) {
  service_.tiles = {{{0, -1, 2}, full_tile(1)}};
  const auto response = get("/api/v1/sites/yard/tiles/0/-1/2");
  EXPECT_EQ(response.result_int(), 200U);
  EXPECT_EQ(response[http::field::content_type], "application/octet-stream");
  const std::vector<std::uint8_t> bytes(response.body().begin(), response.body().end());
  const auto tile = proto::read_tile_snapshot(bytes);
  ASSERT_TRUE(tile) << tile.error().message;
  EXPECT_EQ(*tile, *service_.tiles[0].second);
}

TEST_F(HttpTest, AnswersWhatIsNotThereWith404AsJson) {
  for (const char* target :
       {"/", "/index.html", "/api/v1/sites/yard/tiles/0/0/0", "/api/v1/sites/moon/tiles/0/0/0",
        "/api/v1/sites/yard/tiles/0/0", "/api/v1/sites/yard/tiles/0/0/0/0",
        "/api/v1/sites/yard/tiles/999/0/0", "/api/v1/sites/yard/tiles/0/99999999999/0",
        "/api/v1/sites/yard/tiles/0/x/0", "/api/v1/sites//tiles/0/0/0", "/healthz/"}) {
    const auto response = get(target);
    EXPECT_EQ(response.result_int(), 404U) << target;
    EXPECT_EQ(json::parse(response.body())["error"]["code"], "not_found") << target;
  }
}

TEST_F(HttpTest, AnswersOnlyGet) {
  EXPECT_EQ(ask({http::verb::delete_, "/healthz", 11}).result_int(), 405U);
}

TEST_F(HttpTest, RefusesABody) {
  http::request<http::string_body> request(http::verb::post, "/api/v1/status", 11);
  request.body() = "{}";
  EXPECT_EQ(ask(request).result_int(), 413U);
}

TEST_F(HttpTest, RefusesHeadersBeyondTheBound) {
  http::request<http::string_body> request(http::verb::get, "/healthz", 11);
  request.set("X-Long", std::string(kMaxHeaderBytes, 'x'));
  EXPECT_EQ(ask(request).result_int(), 413U);
}

TEST_F(HttpTest, AnswersSeveralRequestsOnOneConnection) {
  auto socket = connect();
  beast::flat_buffer buffer;
  for (int i = 0; i < 3; ++i) {
    http::write(socket, http::request<http::empty_body>(http::verb::get, "/healthz", 11));
    Response response;
    http::read(socket, buffer, response);
    EXPECT_EQ(response.body(), "ok\n");
  }
}

TEST_F(HttpTest, ClosesAConnectionThatSpeaksNoHttp) {
  auto socket = connect();
  net::write(socket, net::buffer(std::string("\x16\x03\x01 nonsense\r\n\r\n")));
  std::array<char, 64> bytes{};
  beast::error_code fault;
  socket.read_some(net::buffer(bytes), fault);
  EXPECT_TRUE(fault == net::error::eof || fault == net::error::connection_reset) << fault.message();
}

}  // namespace
}  // namespace cairn::server
