// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cmath>
#include <cstdint>

namespace tactus::control {

/// Whether a loop misses so many of its ticks that it must not control a motor, though none of its gaps is long. The
/// share of missed ticks forgets with the time constant τ:
///
///     s ← s + (1 − exp(−T/τ))·(missed − s)   for each tick that was due, missed being 1 or 0
///
/// A single gap t brings it to 1 − exp(−t/τ) and no higher: 20 ms in 0.5 s are 0.04. A loop that misses the share m for
/// ever passes the limit s₀ after −τ·ln(1 − s₀/m): every second tick after 0.51 τ where s₀ is 0.2. What a mean over a
/// window states as well, but in one number. Like the success rate of commands in libfranka, over which its robot
/// stops.
class OverloadCheck {
 public:
  struct Params {
    double missed_share = 0.2;
    double window_s = 0.5;
    static constexpr auto fields() {
      return List{field("missed_share", &Params::missed_share, units::none, positive_up_to(0.9),
                        "Share of missed control cycles above which the site holds."),
                  field("window_s", &Params::window_s, units::second, positive_up_to(10.0),
                        "Time constant of the average that gives this share.")};
    }
  };
  struct Input {
    std::int64_t elapsed_ticks = 1;  ///< since the step before; all but one were missed
  };
  /// Whether the loop is overloaded.
  using Output = bool;

  static Result<OverloadCheck> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return OverloadCheck(params.missed_share, std::exp(-dt.value / params.window_s));
  }

  /// Real-time safe.
  bool step(const Input& input) noexcept {
    if (input.elapsed_ticks > 1) {
      share_ = 1.0 - (1.0 - share_) * std::pow(kept_, static_cast<double>(input.elapsed_ticks - 1));
    }
    const bool overloaded = share_ > most_;
    share_ *= kept_;
    return overloaded;
  }
  /// As if no tick had been missed.
  void reset() noexcept { share_ = 0.0; }

 private:
  OverloadCheck(double most, double kept) : most_(most), kept_(kept) {}

  double most_;
  double kept_;  ///< of the share, over a tick
  double share_ = 0.0;
};

}  // namespace tactus::control
