#include "server/api/api_server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <utility>

#include "server/api/connections.h"
#include "server/api/http_session.h"

namespace cairn::server {

namespace net = boost::asio;
using boost::system::error_code;
using net::ip::tcp;

/// Accepts connections, on a strand.
class ApiServer::Listener : public std::enable_shared_from_this<Listener> {
 public:
  Listener(net::io_context& io, Service& service)
      : io_(io),
        service_(service),
        acceptor_(net::make_strand(io)),
        pause_(acceptor_.get_executor()) {}

  Status listen(const ApiConfig& config);
  void accept();
  void stop();
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  void on_accept(error_code fault, tcp::socket socket);

  net::io_context& io_;
  Service& service_;
  tcp::acceptor acceptor_;
  net::steady_timer pause_;
  std::uint16_t port_ = 0;
  std::shared_ptr<Connections> connections_ = std::make_shared<Connections>();
};

Status ApiServer::Listener::listen(const ApiConfig& config) {
  error_code fault;
  const auto address = net::ip::make_address(config.address, fault);
  if (fault) {
    return Error{ErrorCode::invalid_argument,
                 "\"" + config.address + "\" is no IP address: give one of this machine"};
  }
  const tcp::endpoint endpoint(address, config.port);
  acceptor_.open(endpoint.protocol(), fault);
  if (!fault) acceptor_.set_option(net::socket_base::reuse_address(true), fault);
  if (!fault) acceptor_.bind(endpoint, fault);
  if (!fault) acceptor_.listen(net::socket_base::max_listen_connections, fault);
  const std::string where = "port " + std::to_string(config.port) + " on " + config.address;
  if (fault == net::error::address_in_use) {
    return Error{ErrorCode::conflict,
                 where + " is in use: stop the other program or choose --port"};
  }
  if (fault) return Error{ErrorCode::io, "cannot listen to " + where + ": " + fault.message()};
  port_ = acceptor_.local_endpoint().port();
  return {};
}

void ApiServer::Listener::accept() {
  acceptor_.async_accept(net::make_strand(io_),
                         [self = shared_from_this()](error_code fault, tcp::socket socket) {
                           self->on_accept(fault, std::move(socket));
                         });
}

void ApiServer::Listener::on_accept(error_code fault, tcp::socket socket) {
  if (!acceptor_.is_open()) return;
  if (!fault) {
    if (auto place = connections_->enter()) {
      run_http_session(std::move(socket), service_, connections_, std::move(place));
    }  // Else the socket closes here: the peer may try again when others have gone.
    return accept();
  }
  // Out of file descriptors, most likely: give others time to close theirs.
  pause_.expires_after(std::chrono::milliseconds(100));
  pause_.async_wait([self = shared_from_this()](error_code) {
    if (self->acceptor_.is_open()) self->accept();
  });
}

void ApiServer::Listener::stop() {
  net::post(acceptor_.get_executor(), [self = shared_from_this()] {
    error_code ignored;
    self->acceptor_.close(ignored);
    self->pause_.cancel();
  });
  connections_->close_all();
}

Result<std::unique_ptr<ApiServer>> ApiServer::start(net::io_context& io, const ApiConfig& config,
                                                    Service& service) {
  auto listener = std::make_shared<Listener>(io, service);
  if (auto listening = listener->listen(config); !listening) return listening.error();
  listener->accept();
  return std::unique_ptr<ApiServer>(new ApiServer(std::move(listener)));
}

ApiServer::ApiServer(std::shared_ptr<Listener> listener) : listener_(std::move(listener)) {}
ApiServer::~ApiServer() { stop(); }
void ApiServer::stop() { listener_->stop(); }
std::uint16_t ApiServer::port() const { return listener_->port(); }

}  // namespace cairn::server
