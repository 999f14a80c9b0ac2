// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/server.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

/// The inside of the server: what all its connections share, and what each is. Included by the server's sources alone.
/// All of it runs on the server's one thread, save the counts.
namespace tactus::live {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
/// Without compression, which no side takes up and whose code takes its time to compile.
using WebSocket = websocket::stream<beast::tcp_stream, false>;

inline std::chrono::nanoseconds duration(double seconds) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * seconds));
}

inline std::string in_url(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

struct Server::State {
  State(const ServerOptions& server_options, StaticFiles files, Application& served)
      : options(server_options), page(std::move(files)), application(served) {}

  class Connection;
  class Client;

  Check listen();
  void run() noexcept;
  void accept();
  void collect();
  void collect_later();
  void tell_parameters();
  [[nodiscard]] std::vector<std::shared_ptr<Client>> connected() const;
  [[nodiscard]] bool is_host(std::string_view host) const;

  const ServerOptions options;
  const StaticFiles page;
  Application& application;
  std::vector<std::string> hosts;  ///< with port
  std::uint16_t port = 0;
  std::size_t connections = 0;
  bool accepting = false, collecting = false;  ///< something waits that will call it
  std::uint64_t collections = 0;
  ClientId next_client = 1;
  std::map<ClientId, std::weak_ptr<Client>> clients;
  std::atomic<std::uint64_t> accepted{0}, turned_away{0}, refused{0}, client_count{0}, dropped{0};
  // Its end ends the clients that wait in it, and those take leave of all that is above.
  asio::io_context io{1};
  Tcp::acceptor acceptor{io};
  asio::steady_timer timer{io};
  asio::steady_timer timer_for_accept{io};
  std::thread thread;
};

/// A client in the Foxglove protocol, from the handshake to the end.
class Server::State::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(State& server, beast::tcp_stream stream);
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client();

  void run(const http::request<http::empty_body>& request, std::string_view subprotocol);

  void show(std::size_t topic, std::uint64_t time_ns, const Payload& payload) {
    conversation_.show(topic, time_ns, payload);
  }
  void begin_turn(std::size_t bytes) { conversation_.begin_turn(bytes); }
  [[nodiscard]] bool wants(std::size_t topic) const { return conversation_.wants(topic); }
  [[nodiscard]] bool wants_anything() const { return conversation_.wants_anything(); }
  void tell_parameters(const std::vector<Parameter>& all) { conversation_.tell_parameters(all); }

  /// Counts what was lost, and lets the client know.
  void count_losses();
  /// Sends what waits, and ends a client that cannot be helped. Each collection calls it, the first ones too early.
  void write();
  void close();

 private:
  void read();
  /// Whether the kernel waits for more to come before it sends less than a full segment. So a hundred frames are one
  /// segment, and wake the other side once.
  void cork(bool corked);

  State& server_;
  ClientId id_;
  WebSocket stream_;
  beast::flat_buffer buffer_;
  Conversation conversation_;
  std::uint64_t counted_ = 0;
  bool open_ = false;
  bool corked_ = false;
  std::chrono::steady_clock::time_point speaks_from_;
};

/// A connection until it is known what it wants: one request, one answer, or the way into the Foxglove protocol.
class Server::State::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(State& server, Tcp::socket socket);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection();

  void run();
  /// Says that there is no room, as far as that can be said at once.
  void turn_away();

 private:
  void answer();
  void refuse(http::status status, const std::string& why);
  void send(http::status status, const std::string& content, const std::string& type, bool head);

  State& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
};

}  // namespace tactus::live
