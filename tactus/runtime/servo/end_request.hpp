// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace tactus::runtime {

/// The longest that forces may take to fall to zero at an end that was asked for, in s; what is left of them then goes
/// at once. At the usual limits of the gates it takes a tick, at tight ones some tens of ms.
inline constexpr double longest_ramp_s = 0.5;

/// How somebody outside asks what runs in real time to end. Any thread. Real-time safe.
class EndRequest {
 public:
  /// To come to its end: its forces fall to zero at the rate limits of their gates, and it reports how it went.
  void ask() noexcept { asked_.store(true, std::memory_order_relaxed); }
  /// To give no force from the next tick on.
  void insist() noexcept {
    insisted_.store(true, std::memory_order_relaxed);
    ask();
  }
  [[nodiscard]] bool asked() const noexcept { return asked_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool insisted() const noexcept { return insisted_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> asked_{false};
  std::atomic<bool> insisted_{false};
};

}  // namespace tactus::runtime
