#include <tactus/live/server.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace tactus::live {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;

namespace {

/// How often losses are counted and told: about once a second.
constexpr std::uint64_t collections_between_counts = 200;

/// From the end of the handshake to the first message. Clients of others (mcap-record, for one) listen only some turns
/// of their event loop after the connection stands, and for ever miss what came in one piece with the handshake.
constexpr std::chrono::milliseconds before_first_word{50};

using Clock = std::chrono::steady_clock;
using FileResponse = http::response<http::string_body>;
using Request = http::request<http::empty_body>;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

std::chrono::nanoseconds duration(double seconds) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * seconds));
}

std::string in_url(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

/// The first subprotocol of the request that is spoken here.
std::optional<std::string_view> chosen_subprotocol(const Request& request) {
  const auto header = request.find(http::field::sec_websocket_protocol);
  if (header == request.end()) return std::nullopt;
  for (const auto asked : http::token_list(header->value())) {
    for (const std::string_view ours : subprotocols) {
      if (view(asked) == ours) return ours;
    }
  }
  return std::nullopt;
}

}  // namespace

struct Server::State {
  State(const ServerOptions& server_options, StaticFiles files, Application& served)
      : options(server_options), page(std::move(files)), application(served) {}

  class Connection;
  class Client;

  Check listen();
  void accept();
  void collect();
  void tell_parameters();
  [[nodiscard]] std::vector<std::shared_ptr<Client>> connected() const;
  [[nodiscard]] bool is_host(std::string_view host) const;

  const ServerOptions options;
  const StaticFiles page;
  Application& application;
  std::vector<std::string> hosts;  ///< with port
  std::uint16_t port = 0;
  std::size_t connections = 0;
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
  Client(State& server, beast::tcp_stream stream)
      : server_(server),
        id_(server.next_client++),
        stream_(std::move(stream)),
        conversation_(id_, server.application, server.options.conversation) {
    ++server_.connections;
    ++server_.client_count;
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() {
    --server_.connections;
    --server_.client_count;
    server_.dropped += conversation_.outbox().dropped() - counted_;
    server_.clients.erase(id_);
    server_.application.leave(id_);
  }

  void run(const Request& request, std::string_view subprotocol) {
    server_.clients[id_] = weak_from_this();
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout{.handshake_timeout = duration(server_.options.request_within_s),
                                                       .idle_timeout = duration(server_.options.silence_s),
                                                       .keep_alive_pings = true});
    stream_.set_option(websocket::stream_base::decorator([name = std::string(subprotocol)](auto& response) {
      response.set(http::field::sec_websocket_protocol, name);
    }));
    stream_.read_message_max(server_.options.frame_bytes);
    stream_.auto_fragment(false);
    beast::error_code ignored;
    auto& socket = beast::get_lowest_layer(stream_).socket();
    socket.set_option(Tcp::no_delay(true), ignored);
    // What waits in the kernel cannot be dropped any more, and a live view wants what is new: seconds of a slow
    // client's past wait there otherwise. The kernel doubles the figure.
    socket.set_option(asio::socket_base::send_buffer_size(32768), ignored);
    stream_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      self->open_ = true;
      self->speaks_from_ = Clock::now() + before_first_word;
      self->read();
    });
  }

  void show(std::size_t topic, std::uint64_t time_ns, const Payload& payload) {
    conversation_.show(topic, time_ns, payload);
  }
  [[nodiscard]] bool wants(std::size_t topic) const { return conversation_.wants(topic); }
  void tell_parameters(const std::vector<Parameter>& all) { conversation_.tell_parameters(all); }

  /// Counts what was lost, and lets the client know.
  void count_losses() {
    server_.dropped += conversation_.outbox().dropped() - counted_;
    counted_ = conversation_.outbox().dropped();
    conversation_.tell_losses();
  }

  /// Sends what waits, and ends a client that cannot be helped. Each collection calls it, the first ones too early.
  void write() {
    Outbox& outbox = conversation_.outbox();
    if (conversation_.is_hopeless()) return close();
    if (!open_ || Clock::now() < speaks_from_ || outbox.is_sending() || outbox.empty()) return;
    const Frame& frame = outbox.begin_sending();
    stream_.binary(frame.binary);
    const std::array<asio::const_buffer, 2> bytes{asio::buffer(frame.head),
                                                  frame.payload ? asio::buffer(*frame.payload) : asio::const_buffer{}};
    stream_.async_write(bytes, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->close();
      self->conversation_.outbox().sent();
      self->write();
    });
  }

  void close() {
    open_ = false;
    beast::error_code ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
  }

 private:
  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->close();
      const auto data = self->buffer_.cdata();
      const std::string_view message(static_cast<const char*>(data.data()), data.size());
      bool changed = false;
      if (self->stream_.got_text()) {
        changed = self->conversation_.take_text(message);
      } else {
        self->conversation_.take_binary(message);
      }
      self->buffer_.consume(self->buffer_.size());
      if (changed) self->server_.tell_parameters();
      self->write();
      if (self->open_) self->read();
    });
  }

  State& server_;
  ClientId id_;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer buffer_;
  Conversation conversation_;
  std::uint64_t counted_ = 0;
  bool open_ = false;
  Clock::time_point speaks_from_;
};

/// A connection until it is known what it wants: one request, one answer, or the way into the Foxglove protocol.
class Server::State::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(State& server, Tcp::socket socket)
      : server_(server), stream_(std::move(socket)), buffer_(server.options.header_bytes + 1024) {
    ++server_.connections;
    parser_.header_limit(static_cast<std::uint32_t>(server_.options.header_bytes));
    parser_.body_limit(0);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { --server_.connections; }

  void run() {
    stream_.expires_after(duration(server_.options.request_within_s));
    http::async_read_header(stream_, buffer_, parser_,
                            [self = shared_from_this()](beast::error_code error, std::size_t) {
                              if (!error) return self->answer();
                              if (error == http::error::header_limit || error == http::error::buffer_overflow) {
                                return self->refuse(http::status::request_header_fields_too_large,
                                                    "The head of the request is too long.\n");
                              }
                              if (error.category() == make_error_code(http::error::bad_method).category()) {
                                self->refuse(http::status::bad_request, "That is no HTTP request.\n");
                              }
                            });
  }

  /// Says that there is no room, as far as that can be said at once.
  void turn_away() {
    send(http::status::service_unavailable, "Too many clients; try again when one has gone.\n",
         "text/plain; charset=utf-8", false);
  }

 private:
  void answer() {
    const Request& request = parser_.get();
    if (!server_.is_host(view(request[http::field::host])) || request.count(http::field::host) != 1) {
      return refuse(http::status::misdirected_request, "This server does not go by that name.\n");
    }
    const bool has_origin = request.count(http::field::origin) > 0;
    const std::string own_origin = "http://" + std::string(view(request[http::field::host]));
    if (has_origin && (request.count(http::field::origin) != 1 || view(request[http::field::origin]) != own_origin)) {
      return refuse(http::status::forbidden, "Pages of other origins have no access.\n");
    }
    if (websocket::is_upgrade(request)) {
      const auto subprotocol = chosen_subprotocol(request);
      if (!subprotocol) {
        return refuse(http::status::bad_request, "The subprotocols here are foxglove.sdk.v1, foxglove.websocket.v1.\n");
      }
      return std::make_shared<Client>(server_, std::move(stream_))->run(request, *subprotocol);
    }
    const bool head = request.method() == http::verb::head;
    if (!head && request.method() != http::verb::get) {
      return refuse(http::status::method_not_allowed, "Only GET and HEAD are understood.\n");
    }
    const std::string_view target = view(request.target());
    if (target == "/healthz") return send(http::status::ok, "ok\n", "text/plain; charset=utf-8", head);
    if (const StaticFile* file = server_.page.find(target)) {
      return send(http::status::ok, file->content, file->type, head);
    }
    send(http::status::not_found,
         server_.page.empty() ? "The page is not built. Foxglove and PlotJuggler find their data at this address.\n"
                              : "There is no such file.\n",
         "text/plain; charset=utf-8", head);
  }

  void refuse(http::status status, const std::string& why) {
    ++server_.refused;
    send(status, why, "text/plain; charset=utf-8", false);
  }

  void send(http::status status, const std::string& content, const std::string& type, bool head) {
    response_.result(status);
    response_.version(11);
    response_.keep_alive(false);
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-cache");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Cross-Origin-Opener-Policy", "same-origin");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set(
        "Content-Security-Policy",
        "default-src 'self'; script-src 'self' blob:; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
        "connect-src 'self' ws://" +
            in_url(server_.options.address) + ":" + std::to_string(server_.port) +
            " ws://localhost:" + std::to_string(server_.port) + "; frame-ancestors 'none'; base-uri 'none'");
    if (status == http::status::method_not_allowed) response_.set(http::field::allow, "GET, HEAD");
    response_.content_length(content.size());
    if (!head) response_.body() = content;
    stream_.expires_after(duration(server_.options.request_within_s));
    serializer_.emplace(response_);
    serializer_->split(head);
    const auto done = [self = shared_from_this()](beast::error_code, std::size_t) {
      beast::error_code ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    };
    if (head) {
      http::async_write_header(stream_, *serializer_, done);
    } else {
      http::async_write(stream_, *serializer_, done);
    }
  }

  State& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  FileResponse response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
};

Check Server::State::listen() {
  const auto refuse = [this](const beast::error_code& error) {
    std::string remedy = "choose another with --listen and --port";
    if (error == asio::error::address_in_use) remedy = "another program listens there; choose another with --port";
    if (error == asio::error::access_denied) remedy = "ports below 1024 are reserved; choose another with --port";
    return Error{.code = ErrorCode::unwritable,
                 .parameter = {},
                 .message = "cannot listen: " + error.message() + ": " + remedy,
                 .place = in_url(options.address) + ":" + std::to_string(options.port)};
  };
  beast::error_code error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error) return refuse(error);
  if (address.is_unspecified()) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = {},
                 .message =
                     "listening on every address is refused, for the Host of each request is compared with the "
                     "address: name one address of this machine with --listen",
                 .place = options.address};
  }
  const Tcp::endpoint endpoint(address, options.port);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) return refuse(error);
  port = acceptor.local_endpoint(error).port();
  if (error) return refuse(error);
  for (const std::string& name :
       {in_url(options.address), std::string("127.0.0.1"), std::string("localhost"), std::string("[::1]")}) {
    hosts.push_back(name + ":" + std::to_string(port));
    if (port == 80) hosts.push_back(name);
  }
  return std::nullopt;
}

bool Server::State::is_host(std::string_view host) const {
  return std::find(hosts.begin(), hosts.end(), host) != hosts.end();
}

std::vector<std::shared_ptr<Server::State::Client>> Server::State::connected() const {
  std::vector<std::shared_ptr<Client>> all;
  for (const auto& [id, weak] : clients) {
    if (auto client = weak.lock()) all.push_back(std::move(client));
  }
  return all;
}

void Server::State::accept() {
  acceptor.async_accept([this](beast::error_code error, Tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) {
      // Out of descriptors, most likely: trying at once again would only burn time.
      timer_for_accept.expires_after(std::chrono::milliseconds(100));
      timer_for_accept.async_wait([this](beast::error_code stopped) {
        if (!stopped) accept();
      });
      return;
    }
    ++accepted;
    const bool full = connections >= options.clients;
    const auto connection = std::make_shared<Connection>(*this, std::move(socket));
    if (full) {
      ++turned_away;
      connection->turn_away();
    } else {
      connection->run();
    }
    accept();
  });
}

void Server::State::tell_parameters() {
  const std::vector<Parameter> all = application.parameters();
  for (const auto& client : connected()) {
    client->tell_parameters(all);
    client->write();
  }
}

void Server::State::collect() {
  const std::vector<std::shared_ptr<Client>> all = connected();
  application.collect(
      [&all](std::size_t topic) {
        return std::any_of(all.begin(), all.end(), [topic](const auto& client) { return client->wants(topic); });
      },
      [&all](std::size_t topic, std::uint64_t time_ns, const Payload& payload) {
        for (const auto& client : all) client->show(topic, time_ns, payload);
      });
  const bool count = ++collections % collections_between_counts == 0;
  for (const auto& client : all) {
    if (count) client->count_losses();
    client->write();
  }
  timer.expires_after(duration(options.collect_every_s));
  timer.async_wait([this](beast::error_code stopped) {
    if (!stopped) collect();
  });
}

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}
Server::Server(Server&&) noexcept = default;

Result<Server> Server::start(const ServerOptions& options, StaticFiles page, Application& application) {
  auto state = std::make_unique<State>(options, std::move(page), application);
  if (auto error = state->listen()) return *std::move(error);
  state->thread = std::thread([&server = *state] {
    server.accept();
    server.collect();
    server.io.run();
  });
  return Server(std::move(state));
}

Server::~Server() {
  if (!state_) return;
  asio::post(state_->io, [&server = *state_] {
    beast::error_code ignored;
    server.acceptor.close(ignored);
    server.timer.cancel();
    server.timer_for_accept.cancel();
    server.io.stop();
  });
  state_->thread.join();
}

std::uint16_t Server::port() const { return state_->port; }

std::string Server::url() const {
  return "http://" + in_url(state_->options.address) + ":" + std::to_string(state_->port) + "/";
}

ServerCounts Server::counts() const {
  return {.accepted = state_->accepted,
          .turned_away = state_->turned_away,
          .refused = state_->refused,
          .clients = state_->client_count,
          .dropped = state_->dropped};
}

}  // namespace tactus::live
