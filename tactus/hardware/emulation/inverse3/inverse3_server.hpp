// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/inverse3/inverse3_service.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace tactus::emulation::inverse3 {

/// An emulated Inverse Service at a port of the loopback: WebSocket and HTTP on the same one, as the vendor's. One
/// thread does all; clients share the devices. It continues when a client leaves.
class Inverse3Server {
 public:
  /// Begins to listen, at any free port where it is 0, and starts the thread. Errors: those of `Inverse3Service::make`;
  /// `unwritable` for a port that cannot be had.
  static Result<Inverse3Server> start(const Inverse3Service::Params& params, std::uint16_t port);
  Inverse3Server(Inverse3Server&&) noexcept;
  Inverse3Server& operator=(Inverse3Server&&) = delete;
  /// Closes every connection and ends the thread.
  ~Inverse3Server();

  /// Runs this with the service and the present time on the server's thread, and returns after it. Not after the end.
  void with_service(const std::function<void(Inverse3Service& service, std::int64_t now_ns)>& call);
  [[nodiscard]] std::uint16_t port() const;
  /// `ws://127.0.0.1:10001`
  [[nodiscard]] std::string url() const;

 private:
  struct State;
  explicit Inverse3Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tactus::emulation::inverse3
