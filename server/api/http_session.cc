#include "server/api/http_session.h"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <optional>
#include <utility>

#include "server/api/limits.h"
#include "server/api/routes.h"
#include "server/api/web_socket_session.h"

namespace cairn::server {

namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
using beast::error_code;

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(net::ip::tcp::socket socket, Service& service,
              std::shared_ptr<Connections> connections, std::unique_ptr<Connections::Place> place)
      : stream_(std::move(socket)),
        service_(service),
        connections_(std::move(connections)),
        place_(std::move(place)) {}

  void run() {
    place_->on_close_all([weak = weak_from_this(), strand = stream_.get_executor()] {
      net::post(strand, [weak] {
        if (const auto self = weak.lock()) self->close();
      });
    });
    net::post(stream_.get_executor(), [self = shared_from_this()] { self->read(); });
  }

 private:
  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeaderBytes);
    parser_->body_limit(kMaxHttpBodyBytes);
    stream_.expires_after(kHttpTimeout);
    http::async_read(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](error_code fault, std::size_t) { self->on_read(fault); });
  }

  void on_read(error_code fault) {
    if (fault == http::error::body_limit || fault == http::error::header_limit) {
      keep_alive_ = false;
      return answer(json_answer(413, ErrorCode::invalid_argument, "request too large"));
    }
    if (fault) return close();
    const auto& request = parser_->get();
    keep_alive_ = request.keep_alive();
    const std::string target(request.target());
    if (beast::websocket::is_upgrade(request) && target == kWebSocketTarget) return upgrade();
    if (request.method() != http::verb::get) {
      return answer(json_answer(405, ErrorCode::invalid_argument, "only GET is answered"));
    }
    respond(service_, *connections_, target,
            [weak = weak_from_this(), strand = stream_.get_executor()](HttpAnswer reply) {
              net::post(strand, [weak, reply = std::move(reply)]() mutable {
                const auto self = weak.lock();
                if (self && self->waiting_) self->answer(std::move(reply));
              });
            });
    await_answer();
  }

  /// Stays alive until the service has answered, or says that it did not in time.
  void await_answer() {
    stream_.expires_never();
    waiting_ = true;
    patience_.expires_after(kHttpTimeout);
    patience_.async_wait([self = shared_from_this()](error_code) {
      if (self->waiting_) {
        self->answer(json_answer(503, ErrorCode::unavailable, "no answer in time: try again"));
      }
    });
  }

  /// A page of another site, open in the operator's browser, must not drive robots: browsers name
  /// the page's origin, and it has to be this server.
  [[nodiscard]] bool from_elsewhere() const {
    const auto& request = parser_->get();
    const auto origin = request[http::field::origin];
    const auto host = request[http::field::host];
    return !origin.empty() && origin != "http://" + std::string(host) &&
           origin != "https://" + std::string(host);
  }

  void upgrade() {
    if (from_elsewhere()) {
      keep_alive_ = false;
      return answer(json_answer(403, ErrorCode::invalid_argument,
                                "this page's origin may not use the API: open it from here"));
    }
    stream_.expires_never();
    run_web_socket_session(std::move(stream_), parser_->release(), service_, std::move(place_));
  }

  void answer(HttpAnswer reply) {
    if (std::exchange(waiting_, false)) patience_.cancel();
    response_ = {};
    response_.result(static_cast<unsigned>(reply.code));
    response_.set(http::field::content_type, reply.content_type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.body() = std::move(reply.body);
    response_.keep_alive(keep_alive_);
    response_.prepare_payload();
    stream_.expires_after(kHttpTimeout);
    http::async_write(stream_, response_,
                      [self = shared_from_this()](error_code fault, std::size_t) {
                        if (fault || !self->keep_alive_) return self->close();
                        self->read();
                      });
  }

  void close() {
    if (std::exchange(waiting_, false)) patience_.cancel();
    stream_.close();
  }

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kMaxHeaderBytes};
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
  bool keep_alive_ = false;
  Service& service_;
  std::shared_ptr<Connections> connections_;
  std::unique_ptr<Connections::Place> place_;
  net::steady_timer patience_{stream_.get_executor()};
  bool waiting_ = false;  ///< For the service's answer.
};

}  // namespace

void run_http_session(net::ip::tcp::socket socket, Service& service,
                      std::shared_ptr<Connections> connections,
                      std::unique_ptr<Connections::Place> place) {
  std::make_shared<HttpSession>(std::move(socket), service, std::move(connections),
                                std::move(place))
      ->run();
}

}  // namespace cairn::server
