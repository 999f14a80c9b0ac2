// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace tactus::wire {

/// Owns the file that bytes to a device go through. It never blocks. One thread; it may be moved to another.
class Port {
 public:
  /// A serial port at any bit rate, 8 data bits, no parity, one stop bit, raw; bytes from before are thrown away.
  /// Nobody else gets it meanwhile. Errors, each with path, cause and remedy: `missing`; `inconsistent` for no right,
  /// busy, or no serial port; `out_of_bounds` for a rate that the adapter does not do.
  static Result<Port> serial(const std::string& path, std::int64_t bits_per_s);
  /// The end of a new pseudo-terminal that a device has; a driver opens `path()` as a serial port. Raw from the start,
  /// so nothing is echoed, and it stays when a driver leaves. Errors: `failed`.
  static Result<Port> pseudo_terminal();
  /// Both ends of a connection within this process, which keeps packets apart. Errors: `failed`.
  static Result<std::pair<Port, Port>> pair();
  /// A CAN interface as Linux has it (SocketCAN): each packet is a `struct can_frame`, or `struct canfd_frame` where
  /// `flexible`. Bus-off comes as an error frame. Errors: `missing` for no such interface; `inconsistent` where this
  /// kernel has no CAN, or the interface is down.
  static Result<Port> can(const std::string& interface, bool flexible);

  /// A serial port that another process has opened with `serial` and passed on; takes the descriptor. What that process
  /// has not read yet is thrown away. Both may write to it; only one of them may read at a time.
  static Port of_another(int descriptor, std::string path);

  Port(Port&& other) noexcept;
  Port& operator=(Port&& other) noexcept;
  ~Port();

  /// What a user opens, or reads of.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Of a terminal, as whoever opened it has set it; 0 if it is no terminal. One system call.
  [[nodiscard]] std::int64_t bits_per_s() const noexcept;
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  /// How many of the bytes it had room for. Real-time safe: one system call.
  std::size_t write(std::span<const std::uint8_t> bytes) const noexcept;

 private:
  enum class Kind { terminal, socket };
  Port(int descriptor, Kind kind, std::string path) : descriptor_(descriptor), kind_(kind), path_(std::move(path)) {}

  int descriptor_ = -1;
  Kind kind_ = Kind::terminal;
  int kept_open_ = -1;  ///< the other end of a pseudo-terminal
  std::string path_;
};

}  // namespace tactus::wire
