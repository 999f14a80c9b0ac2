// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace tactus::cli {

/// How emulated motors are given faults while they run, and what is reported of them (`emulate --live`).
struct LiveMotors {
  /// Of a fault as a user writes it, with times from now on. Errors: its own.
  std::function<Check(const std::string& fault, std::int64_t now_ns)> inject;
  /// Which motors have power at this time, a bit each, the first motor's the lowest.
  std::function<std::uint32_t(std::int64_t now_ns)> powered;
};

/// Reads faults from standard input, one a line, and prints a line on standard output whenever the power of a motor
/// changes: `power 2 off 1234.567`, with its number and CLOCK_MONOTONIC in s. A fault that is refused is printed on
/// standard error with its reason. The end of the input ends only the reading. Never waits, except for whoever reads
/// the output.
class LiveConsole {
 public:
  explicit LiveConsole(LiveMotors motors) : motors_(std::move(motors)) {}
  /// To be called as often as power is to be looked at; input is read once a millisecond at most.
  void look(std::int64_t now_ns);

 private:
  void read_faults(std::int64_t now_ns);

  LiveMotors motors_;
  std::uint32_t powered_ = 0;
  std::int64_t looked_ns_ = 0;
  std::string line_;
  bool ended_ = false;
};

}  // namespace tactus::cli
