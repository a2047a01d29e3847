#include "server/api/web_socket_session.h"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <optional>
#include <utility>

#include "proto/json/envelope.h"
#include "server/api/methods.h"
#include "server/api/outbox.h"

namespace cairn::server {

namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using beast::error_code;
using UpgradeRequest = http::request<http::empty_body>;

Error unknown_method(const std::string& method) {
  return {ErrorCode::invalid_argument,
          "method: \"" + method.substr(0, 64) +
              "\" is unknown: expected one of \"status\", \"found\", \"goto\", \"stop\", \"plan\", "
              "\"map\", \"watch\", \"unwatch\""};
}

class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(beast::tcp_stream stream, UpgradeRequest request, Service& service,
                   std::unique_ptr<Connections::Place> place)
      : socket_(std::move(stream)),
        request_(std::move(request)),
        service_(service),
        place_(std::move(place)),
        write_timer_(socket_.get_executor()),
        watch_timer_(socket_.get_executor()),
        pause_timer_(socket_.get_executor()) {}

  void run() {
    place_->on_close_all([weak = weak_from_this(), strand = socket_.get_executor()] {
      net::post(strand, [weak] {
        if (const auto self = weak.lock()) self->close();
      });
    });
    socket_.set_option(websocket::stream_base::timeout{kHttpTimeout, kIdleTimeout, true});
    socket_.read_message_max(api::kMaxRequestBytes);
    socket_.async_accept(request_, [self = shared_from_this()](error_code fault) {
      fault ? self->close() : self->read();
    });
  }

 private:
  // ---- reading ----

  /// Reads on unless the peer has enough answers coming: who does not read is not read.
  void read() {
    if (reading_ || closed_) return;
    if (open_requests_ >= kMaxOpenRequests) return pause();
    pause_timer_.cancel();
    reading_ = true;
    socket_.async_read(buffer_, [self = shared_from_this()](error_code fault, std::size_t) {
      self->reading_ = false;
      fault ? self->close() : self->on_message();
    });
  }

  /// Without a read under way this wait keeps the session alive, and ends it when no answer comes.
  void pause() {
    pause_timer_.expires_after(kIdleTimeout);
    pause_timer_.async_wait([self = shared_from_this()](error_code fault) {
      if (!fault) self->close();
    });
  }

  void on_message() {
    ++open_requests_;
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    handle(text);
    read();
  }

  void handle(const std::string& text) {
    if (!socket_.got_text()) {
      return finish(std::nullopt,
                    Error{ErrorCode::invalid_argument, "expected a text message, got binary"});
    }
    api::Request request;
    if (const auto fault = api::parse_request(text, request)) {
      return finish(fault->id, fault->error);
    }
    if (request.method == "watch") return watch(request);
    if (request.method == "unwatch") return unwatch(request);
    if (request.method == "map") return map(request);
    const auto known =
        call_method(service_, request.method, request.params,
                    on_strand<nlohmann::json>([id = request.id](auto& self, auto result) {
                      self.finish(id, std::move(result));
                    }));
    if (!known) finish(request.id, unknown_method(request.method));
  }

  /// Wraps `then` so that the service may call it on any thread and after the connection is gone.
  template <class T, class Then>
  std::function<void(Result<T>)> on_strand(Then then) {
    return [weak = weak_from_this(), strand = socket_.get_executor(), then](Result<T> result) {
      // A read, a write or the pause keeps a live session alive: without one it is gone.
      const auto self = weak.lock();
      if (!self) return;
      net::post(strand, [self, then, result = std::move(result)]() mutable {
        if (!self->closed_) then(*self, std::move(result));
      });
    };
  }

  // ---- methods that are more than one answer ----

  void map(const api::Request& request) {
    const auto params = api::from_json<api::MapRequest>(request.params);
    if (!params) return finish(request.id, params.error());
    if (maps_under_way_ >= kMaxMapTransfers) {
      return finish(request.id,
                    Error{ErrorCode::exhausted,
                          "maps are still being sent on this connection: wait for them"});
    }
    ++maps_under_way_;
    service_.map(params->site.value_or(""),
                 on_strand<Service::Map>([id = request.id](auto& self, auto answer) {
                   self.send_map(id, std::move(answer));
                 }));
  }

  void send_map(std::uint32_t id, Result<Service::Map> answer) {
    if (!answer || answer->tiles.empty()) --maps_under_way_;
    if (!answer) return finish(id, answer.error());
    answer->head.tiles = answer->tiles.size();
    const bool has_tiles = !answer->tiles.empty();
    outbox_.answer(api::result_text(id, answer->head), !has_tiles);
    if (has_tiles) outbox_.map(id, std::move(*answer));
    write();
  }

  void watch(const api::Request& request) {
    const auto params = api::from_json<api::WatchRequest>(request.params);
    if (!params) return finish(request.id, params.error());
    watch_period_ = std::chrono::milliseconds(params->period_ms);
    finish(request.id, nlohmann::json(*params));
    ask_status();
    watch_timer_.expires_after(*watch_period_);
    wait_for_next_status();
  }

  void unwatch(const api::Request& request) {
    const auto params = api::from_json<api::Empty>(request.params);
    if (!params) return finish(request.id, params.error());
    watch_period_.reset();
    watch_timer_.cancel();
    outbox_.forget_status();
    finish(request.id, nlohmann::json(*params));
  }

  void wait_for_next_status() {
    watch_timer_.async_wait([self = shared_from_this()](error_code fault) {
      if (fault || !self->watch_period_ || self->closed_) return;
      self->ask_status();
      self->watch_timer_.expires_after(*self->watch_period_);
      self->wait_for_next_status();
    });
  }

  void ask_status() {
    if (std::exchange(status_asked_, true)) return;
    service_.status(on_strand<api::StatusReply>([](auto& self, auto status) {
      self.status_asked_ = false;
      if (!status || !self.watch_period_) return;
      self.outbox_.status(api::event_text("status", *status));
      self.write();
    }));
  }

  // ---- writing ----

  void finish(std::optional<std::uint32_t> id, Result<nlohmann::json> result) {
    outbox_.answer(
        result ? api::result_text(id.value_or(0), *result) : api::error_text(id, result.error()),
        true);
    write();
  }

  void write() {
    if (writing_ || closed_) return;
    writing_ = outbox_.next();
    if (!writing_) return;
    write_timer_.expires_after(kWriteTimeout);
    write_timer_.async_wait([self = shared_from_this()](error_code fault) {
      if (!fault) self->close();
    });
    socket_.binary(writing_->binary);
    socket_.async_write(net::buffer(writing_->bytes),
                        [self = shared_from_this()](error_code fault, std::size_t) {
                          fault ? self->close() : self->on_written();
                        });
  }

  void on_written() {
    write_timer_.cancel();
    if (writing_->ends_request) --open_requests_;
    if (writing_->ends_request && writing_->binary) --maps_under_way_;
    writing_.reset();
    write();
    read();
  }

  void close() {
    closed_ = true;
    watch_timer_.cancel();
    write_timer_.cancel();
    pause_timer_.cancel();
    beast::get_lowest_layer(socket_).close();
  }

  websocket::stream<beast::tcp_stream> socket_;
  UpgradeRequest request_;
  Service& service_;
  std::unique_ptr<Connections::Place> place_;
  beast::flat_buffer buffer_;
  bool reading_ = false;
  std::size_t open_requests_ = 0;  ///< Read and not yet answered to the end.
  Outbox outbox_;
  std::optional<Outbox::Message> writing_;
  net::steady_timer write_timer_;
  net::steady_timer watch_timer_;
  net::steady_timer pause_timer_;
  std::optional<std::chrono::milliseconds> watch_period_;
  bool status_asked_ = false;
  std::size_t maps_under_way_ = 0;
  bool closed_ = false;
};

}  // namespace

void run_web_socket_session(beast::tcp_stream stream, UpgradeRequest request, Service& service,
                            std::unique_ptr<Connections::Place> place) {
  std::make_shared<WebSocketSession>(std::move(stream), std::move(request), service,
                                     std::move(place))
      ->run();
}

}  // namespace cairn::server
