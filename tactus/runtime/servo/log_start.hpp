// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus::runtime {

/// When a log starts, by two clocks that were read together. The times of its records count from there on
/// CLOCK_MONOTONIC, so that no correction of the wall clock makes them jump.
struct LogStart {
  std::int64_t monotonic_ns = 0;
  std::int64_t unix_ns = 0;  ///< CLOCK_REALTIME: ns since 1970-01-01 UTC

  /// Reads both clocks, the wall clock between two readings of the other, and takes the closest of several such
  /// readings: they belong together within microseconds on an idle machine. Not real-time safe.
  static LogStart now() noexcept;
};

}  // namespace tactus::runtime
