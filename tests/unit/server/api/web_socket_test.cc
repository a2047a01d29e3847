#include <random>

#include "api_fixture.h"
#include "proto/codec/tile_snapshot.h"
#include "proto/json/envelope.h"
#include "server/api/limits.h"

namespace cairn::server {
namespace {

namespace websocket = beast::websocket;

class Client {
 public:
  explicit Client(tcp::socket socket, const std::string& origin = "") : ws_(std::move(socket)) {
    ws_.set_option(websocket::stream_base::decorator([origin](websocket::request_type& request) {
      if (!origin.empty()) request.set(http::field::origin, origin);
    }));
    ws_.read_message_max(64 * 1024 * 1024);
    ws_.handshake("127.0.0.1:1", "/api/v1/ws", fault_);
  }

  void send(const std::string& text) { ws_.write(net::buffer(text), fault_); }
  void send(std::uint32_t id, const std::string& method, const json& params = json::object()) {
    send(api::request_text({id, method, params}));
  }
  /// The next message; empty when the connection has ended.
  std::string read() {
    beast::flat_buffer buffer;
    ws_.read(buffer, fault_);
    return fault_ ? "" : beast::buffers_to_string(buffer.data());
  }
  json read_json() {
    const auto text = read();
    return text.empty() ? json("connection ended: " + fault_.message()) : json::parse(text);
  }
  json ask(const std::string& method, const json& params = json::object()) {
    send(5, method, params);
    return read_json();
  }
  std::string complaint(const std::string& text) {
    send(text);
    const auto answer = read_json();
    return answer.contains("error") ? answer["error"]["message"].get<std::string>() : answer.dump();
  }

  websocket::stream<tcp::socket> ws_;
  beast::error_code fault_;
};

class WebSocketTest : public ApiTest {};

TEST_F(WebSocketTest, AnswersEachMethodWithTheIdOfItsRequest) {
  Client client(connect());
  EXPECT_EQ(client.ask("status")["result"]["version"], "0.1.0");
  EXPECT_EQ(client.ask("found", {{"site", "yard"}})["result"]["cell_size_mm"], 125);
  EXPECT_EQ(client.ask("goto", {{"x_m", -3}, {"y_m", 2.5}})["result"]["command"], 7);
  EXPECT_EQ(service_.last_goto->x_m, -3.0);
  EXPECT_EQ(client.ask("stop", {{"robot", "r2"}})["result"]["robot"], "r2");
  const json place{{"x_m", 1}, {"y_m", 2}};
  const auto plan = client.ask("plan", {{"from", place}, {"to", place}});
  EXPECT_EQ(plan["result"]["status"], "complete");
  EXPECT_EQ(plan["id"], 5);
  EXPECT_EQ(client.ask("watch", {{"period_ms", 10000}})["id"], 5);
}

TEST_F(WebSocketTest, PassesOnTheErrorsOfTheServer) {
  Client client(connect());
  EXPECT_EQ(client.ask("stop", {{"robot", "ghost"}})["error"]["code"], "not_found");
  EXPECT_EQ(client.ask("found", {{"site", "taken"}})["error"]["code"], "conflict");
  EXPECT_EQ(client.ask("map", {{"site", "moon"}})["error"]["code"], "not_found");
}

TEST_F(WebSocketTest, SurvivesEveryMalformedMessageAndNamesWhatIsWrong) {
  Client client(connect());
  EXPECT_THAT(client.complaint("{"), HasSubstr("not JSON"));
  EXPECT_THAT(client.complaint("[1]"), HasSubstr("expected an object"));
  EXPECT_THAT(client.complaint(std::string(20'000, '[')), HasSubstr("nested too deep"));
  EXPECT_THAT(client.complaint(R"({"method":"status"})"), HasSubstr("id: expected"));
  EXPECT_THAT(client.complaint(R"({"id":1,"method":"fly"})"), HasSubstr("\"fly\" is unknown"));
  EXPECT_THAT(client.complaint(R"({"id":1,"method":"goto","params":{"x_m":1}})"),
              HasSubstr("missing key \"y_m\""));
  EXPECT_THAT(client.complaint(R"({"id":1,"method":"goto","params":{"x_m":NaN,"y_m":1}})"),
              HasSubstr("not JSON"));
  EXPECT_THAT(client.complaint(R"({"id":1,"method":"goto","params":{"x_m":1e9,"y_m":1}})"),
              HasSubstr("x_m: expected a number"));
  EXPECT_THAT(client.complaint(R"({"id":1,"method":"status","params":{"x":1}})"),
              HasSubstr("unknown key \"x\""));
  EXPECT_THAT(client.complaint(R"({"id":1,"method":"watch","params":{"period_ms":1}})"),
              HasSubstr("period_ms: expected"));
  client.ws_.binary(true);
  EXPECT_THAT(client.complaint("bytes"), HasSubstr("expected a text message"));
  client.ws_.binary(false);
  EXPECT_EQ(client.ask("status")["result"]["version"], "0.1.0");
}

TEST_F(WebSocketTest, EndsTheConnectionOnAMessageBeyondTheBound) {
  Client client(connect());
  client.send(std::string(api::kMaxRequestBytes + 1, ' '));
  EXPECT_EQ(client.read(), "");
  EXPECT_EQ(client.ws_.reason().code, websocket::close_code::too_big);
}

TEST_F(WebSocketTest, SendsAMapAsItsHeadAndThenItsTiles) {
  service_.tiles = {{{0, -1, 2}, full_tile(1)}, {{1, 3, -4}, full_tile(2)}};
  Client client(connect());
  const auto head = client.ask("map", {{"site", "yard"}});
  EXPECT_EQ(head["result"]["tiles"], 2);
  for (const auto& [key, tile] : service_.tiles) {
    const auto message = client.read();
    EXPECT_TRUE(client.ws_.got_binary());
    const auto tile_head = api::read_tile_head(message);
    ASSERT_TRUE(tile_head);
    EXPECT_EQ(tile_head->request, 5U);
    EXPECT_EQ(tile_head->key, key);
    const std::vector<std::uint8_t> bytes(message.begin() + api::TileHead::kBytes, message.end());
    const auto read = proto::read_tile_snapshot(bytes);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, *tile);
  }
  service_.tiles.clear();
  EXPECT_EQ(client.ask("map")["result"]["tiles"], 0);
  EXPECT_EQ(client.ask("status")["id"], 5);
}

TEST_F(WebSocketTest, AnswersAStopWhileAMapIsOnItsWay) {
  for (int i = 0; i < 4000; ++i) service_.tiles.push_back({{0, i, 0}, full_tile(0)});
  Client client(connect());
  client.send(1, "map");
  EXPECT_EQ(client.read_json()["id"], 1);
  client.send(2, "stop");
  int tiles = 0;
  while (!client.read().empty() && client.ws_.got_binary()) ++tiles;
  EXPECT_LT(tiles, 3990);
}

TEST_F(WebSocketTest, SendsOnlySoManyMapsAtATime) {
  for (int i = 0; i < 3000; ++i) service_.tiles.push_back({{0, i, 0}, full_tile(0)});
  Client client(connect());
  for (std::uint32_t i = 0; i <= kMaxMapTransfers; ++i) client.send(i, "map");
  bool refused = false;
  for (int i = 0; i < 3000 && !refused; ++i) {
    const auto text = client.read();
    ASSERT_FALSE(text.empty());
    refused = client.ws_.got_text() && json::parse(text).contains("error");
  }
  EXPECT_TRUE(refused);
}

TEST_F(WebSocketTest, PushesTheStatusWhileItIsWatched) {
  Client client(connect());
  EXPECT_EQ(client.ask("watch", {{"period_ms", 100}})["result"]["period_ms"], 100);
  for (int i = 0; i < 3; ++i) {
    const auto event = client.read_json();
    EXPECT_EQ(event["event"], "status");
    EXPECT_EQ(event["data"]["version"], "0.1.0");
  }
  client.send(9, "unwatch");
  json answer;
  do {
    answer = client.read_json();
  } while (answer.contains("event"));
  EXPECT_EQ(answer["id"], 9);
  EXPECT_EQ(client.ask("status")["id"], 5) << "events after unwatch";
}

TEST_F(WebSocketTest, GivesASlowReaderOnlyTheNewestStatus) {
  // So large that a status fills the socket's buffers.
  for (int i = 0; i < 1000; ++i) {
    api::RobotJson robot;
    robot.id = "r" + std::to_string(i);
    robot.site = std::string(2000, 'x');
    service_.status_reply.robots.push_back(robot);
  }
  Client client(connect());
  client.ask("watch", {{"period_ms", 100}});
  ASSERT_TRUE(eventually([this] { return service_.status_count() > 15; }));
  client.send(9, "unwatch");
  int events = 0;
  while (client.read_json().contains("event")) ++events;
  EXPECT_LT(events, 10);
}

TEST_F(WebSocketTest, DropsTheAnswerWhenTheConnectionIsGone) {
  service_.holds_back = true;
  {
    Client client(connect());
    client.send(1, "status");
    ASSERT_TRUE(eventually([this] { return service_.held_back_count() == 1; }));
  }
  // Wait until the server has noticed, then answer into the void.
  ASSERT_TRUE(eventually([this] {
    service_.holds_back = false;
    auto socket = connect();
    http::write(socket, http::request<http::empty_body>(http::verb::get, "/metrics", 11));
    beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(socket, buffer, response);
    return response.body().find("\ncairn_api_connections 1\n") != std::string::npos;
  }));
  service_.release();
  Client other(connect());
  EXPECT_EQ(other.ask("status")["id"], 5);
}

TEST_F(WebSocketTest, StopsReadingAPeerWhoHasTooManyRequestsOpen) {
  service_.holds_back = true;
  Client client(connect());
  for (std::uint32_t i = 0; i < 3 * kMaxOpenRequests; ++i) client.send(i, "status");
  ASSERT_TRUE(eventually([this] { return service_.held_back_count() == kMaxOpenRequests; }));
  service_.holds_back = false;
  service_.release();
  for (std::uint32_t i = 0; i < 3 * kMaxOpenRequests; ++i) {
    const auto answer = client.read_json();
    ASSERT_TRUE(answer.contains("result")) << answer;
  }
  EXPECT_EQ(service_.status_count(), static_cast<int>(3 * kMaxOpenRequests));
}

TEST_F(WebSocketTest, IsNotForPagesOfOtherSites) {
  Client own(connect(), "http://127.0.0.1:1");
  EXPECT_FALSE(own.fault_) << own.fault_.message();
  Client other(connect(), "http://evil.example");
  EXPECT_EQ(other.fault_, websocket::error::upgrade_declined) << other.fault_.message();
}

TEST_F(WebSocketTest, OutlivesRandomMessages) {
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const std::string valid = R"({"id":1,"method":"goto","params":{"x_m":1,"y_m":2}})";
  Client client(connect());
  for (int i = 0; i < 500; ++i) {
    auto text = valid;
    for (int change = 0; change < 3; ++change)
      text[random() % text.size()] = static_cast<char>(random() % 96 + 32);
    client.send(text);
    const auto answer = client.read_json();
    ASSERT_TRUE(answer.contains("result") || answer.contains("error")) << text << answer;
  }
}

}  // namespace
}  // namespace cairn::server
