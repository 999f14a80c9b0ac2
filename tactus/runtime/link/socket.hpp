// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace tactus::link {

/// Where a program listens on a network: host and port, IPv4 or IPv6.
class Address {
 public:
  /// Reads `HOST:PORT`, with an IPv6 host as `[::1]:7000`. A name is looked up, which may take seconds. Errors:
  /// `syntax`, `out_of_bounds` for the port, `missing` for a host that nobody knows.
  static Result<Address> parse(std::string_view text);
  /// Every own address of the same family, at this address's port.
  [[nodiscard]] Address any_host() const;

  [[nodiscard]] bool is_ipv6() const noexcept;
  [[nodiscard]] bool is_loopback() const noexcept;
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// As `parse` reads it.
  [[nodiscard]] std::string text() const;
  /// A `sockaddr` and its size.
  [[nodiscard]] const std::byte* data() const noexcept { return data_.data(); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  friend class Socket;
  alignas(8) std::array<std::byte, 128> data_{};
  std::size_t size_ = 0;
};

/// A datagram as it came from the network.
struct Received {
  static constexpr std::size_t longest = 1500;
  std::array<std::byte, longest> data;
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return {data.data(), size}; }
};

/// A UDP socket to one peer that never blocks. The kernel drops what comes from any other address.
///
/// `receive` belongs to one thread; `send` may be called from any. Neither allocates.
class Socket {
 public:
  /// Bound to `local` and connected to `peer`. Errors: `unwritable` for an address that is taken or not one's own.
  static Result<Socket> open(const Address& local, const Address& peer);
  static constexpr std::size_t packets_at_once = 8;
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&& other) noexcept;
  ~Socket();

  /// Takes up to `packets_at_once` waiting datagrams. What is longer than a packet shows as one of size 0. Good until
  /// the next call. Real-time safe: a system call for each and one that finds nothing, which together take less time
  /// than `recvmmsg` does for one.
  std::span<const Received> receive() noexcept;
  /// Hands one datagram to the kernel. False where it did not take it; that is a loss like any other. Real-time safe.
  bool send(std::span<const std::byte> bytes) const noexcept;
  /// Datagrams to this socket that the kernel dropped so far: refused by a filter, or no room. A system call.
  [[nodiscard]] std::uint64_t dropped() const noexcept;
  /// Waits until a datagram is there or the time has passed. For programs without a tick.
  void wait(double longest_s) const noexcept;

  /// Whether both ends are on this host's loopback.
  [[nodiscard]] bool on_loopback() const noexcept { return on_loopback_; }
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

 private:
  using Packets = std::array<Received, packets_at_once>;
  Socket(int descriptor, bool on_loopback);

  int descriptor_ = -1;
  bool on_loopback_ = false;
  std::unique_ptr<Packets> packets_;
};

/// The monotonic clock in ns. Real-time safe.
std::int64_t monotonic_ns() noexcept;

}  // namespace tactus::link
