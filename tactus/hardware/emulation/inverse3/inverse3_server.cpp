// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/inverse3/inverse3_server.hpp>

#include <chrono>
#include <exception>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace tactus::emulation::inverse3 {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Tcp = asio::ip::tcp;
/// Without compression, which no side takes up and whose code takes its time to compile.
using WebSocket = beast::websocket::stream<Tcp::socket, false>;

constexpr std::size_t most_bytes = 65536;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// One client, kept alive by what it waits for.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Tcp::socket socket, Inverse3Service& service)
      : socket_(std::move(socket)), timer_(socket_.get_executor()), service_(&service) {
    parser_.body_limit(most_bytes);
  }

  void run() {
    http::async_read(socket_, buffer_, parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (!error) self->requested();
    });
  }

 private:
  void requested() {
    const auto& request = parser_.get();
    if (beast::websocket::is_upgrade(request)) {
      web_socket_.emplace(std::move(socket_));
      web_socket_->read_message_max(most_bytes);
      web_socket_->text(true);
      web_socket_->async_accept(request, [self = shared_from_this()](beast::error_code error) {
        if (!error) self->tell({.text = self->service_->snapshot(now_ns())});
      });
      return;
    }
    const auto said =
        service_->http(std::string(request.method_string()), std::string(request.target()), request.body());
    response_.result(said.ok ? http::status::ok : http::status::not_found);
    response_.set(http::field::content_type, "application/json");
    response_.body() = said.body;
    response_.keep_alive(false);
    response_.prepare_payload();
    http::async_write(socket_, response_, [self = shared_from_this()](beast::error_code, std::size_t) {
      beast::error_code ignored;
      self->socket_.shutdown(Tcp::socket::shutdown_send, ignored);
    });
  }

  void hear() {
    buffer_.clear();
    web_socket_->async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return;
      auto answer = self->service_->answer(beast::buffers_to_string(self->buffer_.data()), now_ns());
      if (answer.closes) {
        beast::error_code ignored;
        beast::get_lowest_layer(*self->web_socket_).close(ignored);  // in mid tick, without a word
        return;
      }
      if (answer.after_ns == 0) return self->tell(std::move(answer));
      self->timer_.expires_after(std::chrono::nanoseconds(answer.after_ns));
      self->timer_.async_wait([self, answer = std::move(answer)](beast::error_code stopped) {
        if (!stopped) self->tell(answer);
      });
    });
  }

  void tell(Inverse3Service::Answer answer) {
    told_ = std::move(answer.text);
    web_socket_->async_write(asio::buffer(told_), [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (!error) self->hear();
    });
  }

  Tcp::socket socket_;
  asio::steady_timer timer_;
  Inverse3Service* service_;
  beast::flat_buffer buffer_{most_bytes};
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
  std::optional<WebSocket> web_socket_;
  std::string told_;
};

}  // namespace

struct Inverse3Server::State {
  explicit State(Inverse3Service its_service) : service(std::move(its_service)) {}

  void accept() {
    acceptor.async_accept([this](beast::error_code error, Tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) {
        socket.set_option(Tcp::no_delay(true), error);
        std::make_shared<Client>(std::move(socket), service)->run();
      }
      accept();
    });
  }

  Inverse3Service service;
  asio::io_context io{1};
  Tcp::acceptor acceptor{io};
  std::uint16_t port = 0;
  std::thread thread;
};

Inverse3Server::Inverse3Server(std::unique_ptr<State> state) : state_(std::move(state)) {}
Inverse3Server::Inverse3Server(Inverse3Server&&) noexcept = default;

Result<Inverse3Server> Inverse3Server::start(const Inverse3Service::Params& params, std::uint16_t port) {
  auto service = Inverse3Service::make(params);
  if (!service) return service.error();
  auto state = std::make_unique<State>(*std::move(service));
  const Tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
  beast::error_code error;
  state->acceptor.open(endpoint.protocol(), error);
  if (!error) state->acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) state->acceptor.bind(endpoint, error);
  if (!error) state->acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (!error) state->port = state->acceptor.local_endpoint(error).port();
  if (error) {
    return Error{ErrorCode::unwritable,
                 "port",
                 "cannot listen at " + std::to_string(port) + ": " + error.message() + ": name another port",
                 {}};
  }
  state->accept();
  state->thread = std::thread([&io = state->io]() noexcept { io.run(); });
  return Inverse3Server(std::move(state));
}

Inverse3Server::~Inverse3Server() {
  if (!state_) return;
  state_->io.stop();
  state_->thread.join();
}

void Inverse3Server::with_service(const std::function<void(Inverse3Service&, std::int64_t)>& call) {
  std::promise<void> done;
  asio::post(state_->io, [&] {
    call(state_->service, now_ns());
    done.set_value();
  });
  done.get_future().wait();
}

std::uint16_t Inverse3Server::port() const { return state_->port; }

std::string Inverse3Server::url() const { return "ws://127.0.0.1:" + std::to_string(port()); }

}  // namespace tactus::emulation::inverse3
