#include "client/cli/connection.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <csignal>
#include <span>
#include <utility>

#include "proto/codec/tile_snapshot.h"
#include "proto/json/envelope.h"

namespace cairn::cli {

namespace beast = boost::beast;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using beast::error_code;
using net::ip::tcp;

/// The socket with time-outs: each operation runs the loop until it is done or too late.
class Connection::Socket {
 public:
  Socket(const ServerAddress& server, std::chrono::milliseconds timeout)
      : server_(server), timeout_(timeout) {
    socket_.read_message_max(api::kMaxAnswerBytes);
  }

  Status connect();
  Status write(const std::string& text);
  /// False when Ctrl-C was pressed.
  Result<bool> read();
  /// Statuses come every second: shorter patience would end on a healthy server.
  void expect_events() { timeout_ = std::max(timeout_, std::chrono::milliseconds(5000)); }
  void catch_interrupt();
  void close();

  [[nodiscard]] bool got_text() const { return socket_.got_text(); }
  [[nodiscard]] std::string_view bytes() const {
    return {static_cast<const char*>(buffer_.data().data()), buffer_.size()};
  }

 private:
  enum class End { done, late, interrupted };

  /// Starts an operation with `start(handler)` and runs the loop until its end.
  template <class Start>
  End run(error_code& fault, Start start) {
    bool done = false;
    start([&](error_code result) {
      fault = result;
      done = true;
    });
    io_.restart();
    const auto until = std::chrono::steady_clock::now() + timeout_;
    while (!done && !interrupted_ && io_.run_one_until(until) != 0) {
    }
    if (done) return End::done;
    // The operation holds references to our frame: it has to end before we do.
    beast::get_lowest_layer(socket_).close();
    resolver_.cancel();
    interrupts_.cancel();
    io_.restart();
    while (!done && io_.run_one() != 0) {
    }
    return interrupted_ ? End::interrupted : End::late;
  }

  [[nodiscard]] Error nobody() const {
    const auto where = to_string(server_);
    return {ErrorCode::unavailable,
            "no server at " + where + ": start cairn-server or give --server HOST:PORT"};
  }
  [[nodiscard]] Error late() const {
    return {ErrorCode::unavailable,
            "no answer from " + to_string(server_) + " in time: try again or raise --timeout"};
  }
  [[nodiscard]] Error lost(const error_code& fault) const {
    return {ErrorCode::unavailable,
            "lost the server at " + to_string(server_) + ": " + fault.message()};
  }

  ServerAddress server_;
  std::chrono::milliseconds timeout_;
  net::io_context io_;
  tcp::resolver resolver_{io_};
  websocket::stream<beast::tcp_stream> socket_{io_};
  net::signal_set interrupts_{io_};
  bool interrupted_ = false;
  beast::flat_buffer buffer_;
};

Status Connection::Socket::connect() {
  error_code fault;
  tcp::resolver::results_type found;
  auto end = run(fault, [&](auto then) {
    resolver_.async_resolve(server_.host, std::to_string(server_.port),
                            [&found, then](error_code result, tcp::resolver::results_type hosts) {
                              found = std::move(hosts);
                              then(result);
                            });
  });
  if (end != End::done || fault) return nobody();
  end = run(fault, [&](auto then) {
    beast::get_lowest_layer(socket_).async_connect(
        found, [then](error_code result, const tcp::endpoint&) { then(result); });
  });
  if (end != End::done || fault) return nobody();
  beast::get_lowest_layer(socket_).expires_never();
  end = run(fault,
            [&](auto then) { socket_.async_handshake(to_string(server_), "/api/v1/ws", then); });
  if (end != End::done) return late();
  if (fault) {
    return Error{ErrorCode::unavailable,
                 "what listens at " + to_string(server_) +
                     " is no cairn-server, or it is full: check --server HOST:PORT"};
  }
  return {};
}

Status Connection::Socket::write(const std::string& text) {
  error_code fault;
  const auto end = run(fault, [&](auto then) {
    socket_.async_write(net::buffer(text),
                        [then](error_code result, std::size_t) { then(result); });
  });
  if (end != End::done) return late();
  if (fault) return lost(fault);
  return {};
}

Result<bool> Connection::Socket::read() {
  if (interrupted_) return false;
  buffer_.consume(buffer_.size());
  error_code fault;
  const auto end = run(fault, [&](auto then) {
    socket_.async_read(buffer_, [then](error_code result, std::size_t) { then(result); });
  });
  if (end == End::interrupted) return false;
  if (end == End::late) return late();
  if (fault) return lost(fault);
  return true;
}

void Connection::Socket::catch_interrupt() {
  interrupts_.add(SIGINT);
  interrupts_.async_wait([this](error_code fault, int) { interrupted_ = !fault; });
}

void Connection::Socket::close() {
  if (!socket_.is_open() || interrupted_) return;
  timeout_ = std::min(timeout_, std::chrono::milliseconds(1000));
  error_code ignored;
  run(ignored, [&](auto then) { socket_.async_close(websocket::close_code::normal, then); });
}

Connection::Connection(std::unique_ptr<Socket> socket) : socket_(std::move(socket)) {}
Connection::~Connection() { socket_->close(); }

Result<std::unique_ptr<Connection>> Connection::open(const ServerAddress& server,
                                                     std::chrono::milliseconds timeout) {
  auto socket = std::make_unique<Socket>(server, timeout);
  if (auto connected = socket->connect(); !connected) return connected.error();
  return std::unique_ptr<Connection>(new Connection(std::move(socket)));
}

Result<nlohmann::json> Connection::call(const std::string& method, const nlohmann::json& params) {
  const auto id = ++last_request_;
  const auto sent = socket_->write(api::request_text({id, method, params}));
  if (!sent) return sent.error();
  while (true) {
    const auto read = socket_->read();
    if (!read) return read.error();
    if (!*read) return Error{ErrorCode::unavailable, "interrupted"};
    if (!socket_->got_text()) continue;
    auto answer = api::parse_answer(socket_->bytes());
    if (!answer) return answer.error();
    if (!answer->event.empty()) continue;
    if (answer->error) return *answer->error;
    if (answer->id == id) return std::move(answer->body);
  }
}

Result<SiteMap> Connection::map(const std::optional<std::string>& site) {
  auto head = call<api::MapReply>("map", api::MapRequest{site});
  if (!head) return head.error();
  const Error corrupt{ErrorCode::corrupt, "the server sent a map that is damaged: try again"};
  if (head->tiles > SiteMap::kMaxTiles) return corrupt;
  SiteMap map{.head = std::move(*head), .tiles = {}};
  while (map.tiles.size() < map.head.tiles) {
    const auto read = socket_->read();
    if (!read) return read.error();
    if (!*read) return Error{ErrorCode::unavailable, "interrupted"};
    if (socket_->got_text()) continue;
    const auto bytes = socket_->bytes();
    const auto tile_head = api::read_tile_head(bytes);
    if (!tile_head || tile_head->request != last_request_) return corrupt;
    const std::vector<std::uint8_t> body(bytes.begin() + api::TileHead::kBytes, bytes.end());
    const auto tile = proto::read_tile_snapshot(body);
    if (!tile) return tile.error();
    map.tiles.emplace_back(tile_head->key, tile->unpack());
  }
  return map;
}

Result<std::optional<api::StatusReply>> Connection::next_status() {
  socket_->expect_events();
  while (true) {
    const auto read = socket_->read();
    if (!read) return read.error();
    if (!*read) return std::optional<api::StatusReply>();
    if (!socket_->got_text()) continue;
    auto answer = api::parse_answer(socket_->bytes());
    if (!answer) return answer.error();
    if (answer->event != "status") continue;
    auto status = api::from_json<api::StatusReply>(answer->body);
    if (!status) return status.error();
    return std::optional(std::move(*status));
  }
}

void Connection::catch_interrupt() { socket_->catch_interrupt(); }

}  // namespace cairn::cli
