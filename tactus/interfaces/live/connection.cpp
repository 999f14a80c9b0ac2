// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/internal/server_state.hpp>

#include <array>
#include <exception>
#include <utility>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace tactus::live {

namespace {

/// From the end of the handshake to the first message. Clients of others (mcap-record, for one) listen only some turns
/// of their event loop after the connection stands, and for ever miss what came in one piece with the handshake.
constexpr std::chrono::milliseconds before_first_word{50};

using Clock = std::chrono::steady_clock;
using Request = http::request<http::empty_body>;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

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

Server::State::Client::Client(State& server, beast::tcp_stream stream)
    : server_(server),
      id_(server.next_client++),
      stream_(std::move(stream)),
      conversation_(id_, server.application, server.options.conversation) {
  ++server_.connections;
  ++server_.client_count;
}

Server::State::Client::~Client() {
  --server_.connections;
  --server_.client_count;
  server_.dropped += conversation_.outbox().dropped() - counted_;
  server_.clients.erase(id_);
  server_.application.leave(id_);
  if (server_.client_count == 0) server_.application.stand_alone();
}

void Server::State::Client::run(const Request& request, std::string_view subprotocol) {
  server_.clients[id_] = weak_from_this();
  beast::get_lowest_layer(stream_).expires_never();
  stream_.set_option(websocket::stream_base::timeout{.handshake_timeout = duration(server_.options.request_within_s),
                                                     .idle_timeout = duration(server_.options.silence_s),
                                                     .keep_alive_pings = true});
  stream_.set_option(websocket::stream_base::decorator(
      [name = std::string(subprotocol)](auto& response) { response.set(http::field::sec_websocket_protocol, name); }));
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

void Server::State::Client::count_losses() {
  server_.dropped += conversation_.outbox().dropped() - counted_;
  counted_ = conversation_.outbox().dropped();
  conversation_.tell_losses();
}

void Server::State::Client::write() {
  Outbox& outbox = conversation_.outbox();
  if (conversation_.is_hopeless()) return close();
  if (!open_ || Clock::now() < speaks_from_ || outbox.is_sending()) return;
  if (outbox.empty() == corked_) cork(!outbox.empty());
  if (outbox.empty()) return;
  const Frame& frame = outbox.begin_sending();
  stream_.binary(frame.binary);
  const std::array<asio::const_buffer, 2> bytes{asio::buffer(frame.head),
                                                frame.payload ? asio::buffer(*frame.payload) : asio::const_buffer{}};
  try {
    stream_.async_write(bytes, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->close();
      self->conversation_.outbox().sent();
      self->write();
    });
  } catch (const std::exception&) {
    close();  // for lack of memory
  }
}

void Server::State::Client::cork(bool corked) {
  corked_ = corked;
  const int value = corked ? 1 : 0;
  // Where the kernel refuses, frames go out one by one.
  static_cast<void>(setsockopt(beast::get_lowest_layer(stream_).socket().native_handle(), IPPROTO_TCP, TCP_CORK, &value,
                               sizeof(value)));
}

void Server::State::Client::close() {
  open_ = false;
  beast::error_code ignored;
  beast::get_lowest_layer(stream_).socket().close(ignored);
}

void Server::State::Client::read() {
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

Server::State::Connection::Connection(State& server, Tcp::socket socket)
    : server_(server), stream_(std::move(socket)), buffer_(server.options.header_bytes + 1024) {
  ++server_.connections;
  parser_.header_limit(static_cast<std::uint32_t>(server_.options.header_bytes));
  parser_.body_limit(0);
}

Server::State::Connection::~Connection() { --server_.connections; }

void Server::State::Connection::run() {
  stream_.expires_after(duration(server_.options.request_within_s));
  http::async_read_header(stream_, buffer_, parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (!error) return self->answer();
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      return self->refuse(http::status::request_header_fields_too_large, "The head of the request is too long.\n");
    }
    if (error.category() == make_error_code(http::error::bad_method).category()) {
      self->refuse(http::status::bad_request, "That is no HTTP request.\n");
    }
  });
}

void Server::State::Connection::turn_away() {
  send(http::status::service_unavailable, "Too many clients; try again when one has gone.\n",
       "text/plain; charset=utf-8", false);
}

void Server::State::Connection::answer() {
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

void Server::State::Connection::refuse(http::status status, const std::string& why) {
  ++server_.refused;
  send(status, why, "text/plain; charset=utf-8", false);
}

void Server::State::Connection::send(http::status status, const std::string& content, const std::string& type,
                                     bool head) {
  response_.result(status);
  response_.version(11);
  response_.keep_alive(false);
  response_.set(http::field::content_type, type);
  response_.set(http::field::cache_control, "no-cache");
  response_.set("X-Content-Type-Options", "nosniff");
  response_.set("Referrer-Policy", "no-referrer");
  response_.set("Cross-Origin-Opener-Policy", "same-origin");
  response_.set("Cross-Origin-Resource-Policy", "same-origin");
  response_.set("Content-Security-Policy",
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

}  // namespace tactus::live
