// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/application.hpp>
#include <tactus/interfaces/live/conversation.hpp>
#include <tactus/interfaces/live/static_files.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace tactus::live {

/// Who may connect, and how much one may ask for.
struct ServerOptions {
  std::string address = "127.0.0.1";  ///< of this machine, to listen on; loopback alone reaches nobody else
  std::uint16_t port = 8765;          ///< 0 takes any that is free
  std::size_t clients = 64;           ///< connected at once, those of the page's files included; more are turned away
  std::size_t frame_bytes = 65536;    ///< longest message from a client
  std::size_t header_bytes = 8192;    ///< longest head of an HTTP request
  double request_within_s = 5.0;      ///< time for a request to arrive and its answer to be taken
  double silence_s = 20.0;            ///< a client that answers no ping for so long is closed
  double collect_every_s = 0.01;      ///< how often the application is asked for what is new: a turn
  std::size_t bytes_a_turn = std::size_t{4} * 1024 * 1024;  ///< for samples to all clients; each has an equal share
  ConversationLimits conversation;
};

/// What the server saw so far.
struct ServerCounts {
  std::uint64_t accepted = 0;
  std::uint64_t turned_away = 0;  ///< beyond `clients`
  std::uint64_t refused = 0;      ///< requests with a wrong host, origin, method or subprotocol
  std::uint64_t clients = 0;      ///< now, in the Foxglove protocol
  std::uint64_t dropped = 0;      ///< messages to clients that were too slow
};

/// An application on a port: the Foxglove WebSocket protocol, and the files of a page over HTTP.
///
/// One thread does all. It shares nothing with a loop but what the application shares. No client can take more of the
/// thread than its share: subscriptions a client are limited, and a turn has room for so many bytes of samples, shared
/// out equally among those who want any; who wants more loses its own, which is counted and reported. Between two turns
/// each client reads or writes one message before any does the next. A request is answered only where its `Host` is the
/// address that the server was asked to listen on, or a name of the loopback, with the port; and where it has an
/// `Origin`, that is the server's own: a page of another site, or a name that was bound to this address later, reaches
/// nothing.
class Server {
 public:
  /// Begins to listen and starts the thread. `application` must outlive the server. Errors: `unwritable` for an address
  /// or port that cannot be had, with the remedy.
  static Result<Server> start(const ServerOptions& options, StaticFiles page, Application& application);
  Server(Server&&) noexcept;
  Server& operator=(Server&&) = delete;
  /// Closes every connection and ends the thread.
  ~Server();

  [[nodiscard]] std::uint16_t port() const;
  /// Where a browser finds it: `http://127.0.0.1:8765/`.
  [[nodiscard]] std::string url() const;
  /// Any thread.
  [[nodiscard]] ServerCounts counts() const;

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tactus::live
