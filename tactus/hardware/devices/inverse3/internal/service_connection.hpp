// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <memory>
#include <string>

namespace tactus::devices::inverse3 {

/// A WebSocket to Haply's service. Every call ends after its time. Of one thread.
class ServiceConnection {
 public:
  /// Asks for the version (`GET /version`) and connects. Errors: `failed`, with the address.
  static Result<ServiceConnection> open(const std::string& host, const std::string& port, std::int64_t longest_ns);
  ServiceConnection(ServiceConnection&&) noexcept;
  ServiceConnection& operator=(ServiceConnection&&) = delete;
  ~ServiceConnection();

  /// What it answered to that.
  [[nodiscard]] const std::string& version() const;
  /// Errors: `failed` where the connection ended, or this took too long.
  Check send(const std::string& message, std::int64_t longest_ns);
  /// The next message. It is valid until the next call. Errors: as `send`.
  Result<const std::string*> receive(std::int64_t longest_ns);

 private:
  struct State;
  explicit ServiceConnection(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tactus::devices::inverse3
