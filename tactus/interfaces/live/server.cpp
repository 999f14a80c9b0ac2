// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/internal/server_state.hpp>

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

namespace tactus::live {

namespace {

/// How often losses are counted and told: about once a second.
constexpr std::uint64_t collections_between_counts = 100;

}  // namespace

Check Server::State::listen() {
  const auto refuse = [this](const beast::error_code& error) {
    std::string remedy = "name another address and port";
    if (error == asio::error::address_in_use) remedy = "another program listens there; name another port";
    if (error == asio::error::access_denied) remedy = "ports below 1024 are reserved; name another port";
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
                     "address: name one address of this machine",
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

/// Who cannot be served for lack of memory goes without; the others are.
void Server::State::run() noexcept {
  while (!io.stopped()) {
    try {
      if (!accepting) accept();
      if (!collecting) collect_later();
      io.run();
    } catch (const std::exception&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
}

void Server::State::accept() {
  acceptor.async_accept([this](beast::error_code error, Tcp::socket socket) {
    accepting = false;
    if (error == asio::error::operation_aborted) return;
    if (error) {
      // Out of descriptors, most likely: trying at once again would only burn time.
      timer_for_accept.expires_after(std::chrono::milliseconds(100));
      timer_for_accept.async_wait([this](beast::error_code stopped) {
        accepting = false;
        if (!stopped) accept();
      });
      accepting = true;
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
  accepting = true;
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
  const auto listening =
      std::count_if(all.begin(), all.end(), [](const auto& client) { return client->wants_anything(); });
  const std::size_t share = options.bytes_a_turn / static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, listening));
  for (const auto& client : all) client->begin_turn(share);
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
}

void Server::State::collect_later() {
  timer.expires_after(duration(options.collect_every_s));
  timer.async_wait([this](beast::error_code stopped) {
    collecting = false;
    if (stopped) return;
    collect();
    collect_later();
  });
  collecting = true;
}

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}
Server::Server(Server&&) noexcept = default;

Result<Server> Server::start(const ServerOptions& options, StaticFiles page, Application& application) {
  auto state = std::make_unique<State>(options, std::move(page), application);
  if (auto error = state->listen()) return *std::move(error);
  state->thread = std::thread([&server = *state] { server.run(); });
  return Server(std::move(state));
}

Server::~Server() {
  if (!state_) return;
  // Any thread may, and it takes no memory; what is open is closed with the state.
  state_->io.stop();
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
