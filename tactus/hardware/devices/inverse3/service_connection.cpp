// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/inverse3/internal/service_connection.hpp>

#include <chrono>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace tactus::devices::inverse3 {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Tcp = asio::ip::tcp;
/// Without compression, which no side takes up and whose code takes its time to compile.
using WebSocket = beast::websocket::stream<Tcp::socket, false>;

constexpr std::size_t most_bytes = 65536;

Error ended(const std::string& why) {
  return {.code = ErrorCode::failed,
          .parameter = {},
          .message = "the connection to the service ended: " + why,
          .place = {}};
}

/// Runs what `begin` starts with a handler until that was called, so long at most; then `stop` must end it.
template <class Begin, class Stop>
beast::error_code finish(asio::io_context& io, std::int64_t longest_ns, Begin&& begin, Stop&& stop) {
  beast::error_code result = asio::error::timed_out;
  bool done = false;
  begin([&](beast::error_code error, auto&&...) {
    result = error;
    done = true;
  });
  io.restart();
  io.run_for(std::chrono::nanoseconds(longest_ns));
  if (done) return result;
  stop();
  io.restart();
  io.run();
  return asio::error::timed_out;
}

}  // namespace

struct ServiceConnection::State {
  asio::io_context io{1};
  WebSocket stream{io};
  beast::flat_buffer buffer{most_bytes};
  std::string heard, version;

  template <class Begin>
  beast::error_code finish_within(std::int64_t longest_ns, Begin&& begin) {
    return finish(io, longest_ns, begin, [this] {
      beast::error_code ignored;
      beast::get_lowest_layer(stream).close(ignored);
    });
  }
};

ServiceConnection::ServiceConnection(std::unique_ptr<State> state) : state_(std::move(state)) {}
ServiceConnection::ServiceConnection(ServiceConnection&&) noexcept = default;
ServiceConnection::~ServiceConnection() = default;

const std::string& ServiceConnection::version() const { return state_->version; }

Result<ServiceConnection> ServiceConnection::open(const std::string& host, const std::string& port,
                                                  std::int64_t longest_ns) {
  const auto refused = [&](const beast::error_code& error) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "no service answers there (" + error.message() +
                            "): start Haply Hub, or its Inverse Service, and look at the port that it has",
                 .place = host + ":" + port};
  };
  auto state = std::make_unique<State>();
  beast::error_code error;
  const auto endpoints = Tcp::resolver(state->io).resolve(host, port, error);
  if (error) return refused(error);
  const Tcp::endpoint endpoint = *endpoints.begin();
  {
    Tcp::socket socket(state->io);
    const auto stop = [&socket] {
      beast::error_code ignored;
      socket.close(ignored);
    };
    error = finish(
        state->io, longest_ns, [&](auto handler) { socket.async_connect(endpoint, handler); }, stop);
    if (error) return refused(error);
    http::request<http::empty_body> question(http::verb::get, "/version", 11);
    question.set(http::field::host, host);
    error = finish(
        state->io, longest_ns, [&](auto handler) { http::async_write(socket, question, handler); }, stop);
    if (error) return refused(error);
    http::response<http::string_body> answer;
    error = finish(
        state->io, longest_ns, [&](auto handler) { http::async_read(socket, state->buffer, answer, handler); }, stop);
    if (error) return refused(error);
    state->version = answer.body();
    state->buffer.clear();
  }
  auto& socket = beast::get_lowest_layer(state->stream);
  error = state->finish_within(longest_ns, [&](auto handler) { socket.async_connect(endpoint, handler); });
  if (error) return refused(error);
  socket.set_option(Tcp::no_delay(true), error);
  state->stream.read_message_max(most_bytes);
  error = state->finish_within(longest_ns,
                               [&](auto handler) { state->stream.async_handshake(host + ":" + port, "/", handler); });
  if (error) return refused(error);
  state->stream.text(true);
  return ServiceConnection(std::move(state));
}

Check ServiceConnection::send(const std::string& message, std::int64_t longest_ns) {
  const auto error = state_->finish_within(
      longest_ns, [&](auto handler) { state_->stream.async_write(asio::buffer(message), handler); });
  if (error) return ended(error.message());
  return std::nullopt;
}

Result<const std::string*> ServiceConnection::receive(std::int64_t longest_ns) {
  state_->buffer.clear();
  const auto error =
      state_->finish_within(longest_ns, [&](auto handler) { state_->stream.async_read(state_->buffer, handler); });
  if (error) return ended(error.message());
  state_->heard = beast::buffers_to_string(state_->buffer.data());
  return &std::as_const(state_->heard);
}

}  // namespace tactus::devices::inverse3
