// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cstdint>

namespace tactus::control {

/// Barks when nothing was received for a time, and does not stop when something is: a bark is latched until `reset`. It
/// counts the ticks that its caller reports, so a stall counts in full. No time-out switches it off: zero, infinity
/// and all above the bound are refused.
class Watchdog {
 public:
  struct Params {
    double timeout_s = 0.1;
    static constexpr auto fields() {
      return List{field("timeout_s", &Params::timeout_s, units::second, positive_up_to(10.0),
                        "Time without packets after which the watchdog puts the site into hold.")};
    }
  };
  struct Input {
    bool heard = false;
    std::int64_t elapsed_ticks = 1;  ///< since the step before; more after a stall
  };
  /// Whether it barks.
  using Output = bool;

  static Result<Watchdog> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return Watchdog(params.timeout_s, dt.value);
  }

  /// Real-time safe.
  bool step(const Input& input) noexcept {
    silence_s_ = input.heard ? 0.0 : silence_s_ + dt_s_ * static_cast<double>(input.elapsed_ticks);
    // Half a tick, so that sums of ticks which are no binary fractions do not decide.
    barks_ = barks_ || silence_s_ > timeout_s_ - 0.5 * dt_s_;
    return barks_;
  }
  /// Quiet, as if something had been received now.
  void reset() noexcept {
    silence_s_ = 0.0;
    barks_ = false;
  }

  [[nodiscard]] bool barks() const noexcept { return barks_; }
  [[nodiscard]] double silence_s() const noexcept { return silence_s_; }

 private:
  Watchdog(double timeout_s, double dt_s) : timeout_s_(timeout_s), dt_s_(dt_s) {}

  double timeout_s_;
  double dt_s_;
  double silence_s_ = 0.0;
  bool barks_ = false;
};

}  // namespace tactus::control
