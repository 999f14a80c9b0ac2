// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tactus::control {

/// What a motor may give for long: an I²t limit, in forces. The warmth of the winding follows the square of the force,
///
///     w ← w + (1 − exp(−t/τ))·(F² − w),
///
/// F being the force that was held for the time t. Up to three quarters of w = F_c², F_c being the continuous rating,
/// the peak may be given; from there the limit falls in proportion to w until at w = F_c² it is F_c itself. So w never
/// exceeds F_c² by more than a tick's worth, the limit never makes a step, and what is below F_c always passes. From
/// rest a force F is given for −τ·ln(1 − 0.75·F_c²/F²) before anything is taken from it.
///
/// τ and F_c are those of the winding, from the motor's data sheet; what heats up more slowly than the winding (the
/// housing) asks for a lower F_c. Re-arming cools no motor: only `reset` forgets. Source: W. Leonhard, Control of
/// Electrical Drives, 3rd ed., 2001, chapter 4 (thermal model of first order).
class ThermalLimit {
 public:
  struct Params {
    double continuous_force_N = 100.0;
    double time_constant_s = 10.0;
    static constexpr auto fields() {
      return List{field("continuous_force_N", &Params::continuous_force_N, units::newton, positive_up_to(100.0),
                        "Largest root mean square of the force that the motor can apply continuously."),
                  field("time_constant_s", &Params::time_constant_s, units::second, positive_up_to(3600.0),
                        "Time constant of the motor's winding.")};
    }
  };
  struct Input {
    double acted_N = 0.0;            ///< force since the step before
    double peak_N = 0.0;             ///< what may be given while the motor is cool; not negative
    std::int64_t elapsed_ticks = 1;  ///< since the step before
  };
  /// The largest force in N, either way, that may be given now.
  using Output = double;

  static Result<ThermalLimit> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return ThermalLimit(params.continuous_force_N, std::exp(-dt.value / params.time_constant_s));
  }

  /// Real-time safe.
  double step(const Input& input) noexcept {
    const double share = input.acted_N / continuous_N_;
    const double kept = input.elapsed_ticks > 1 ? std::pow(kept_, static_cast<double>(input.elapsed_ticks)) : kept_;
    warmth_ = share * share + kept * (warmth_ - share * share);
    if (input.peak_N <= continuous_N_) return input.peak_N;
    return continuous_N_ + (input.peak_N - continuous_N_) * std::clamp((1.0 - warmth_) / (1.0 - folds_from), 0.0, 1.0);
  }
  /// A motor that was never used.
  void reset() noexcept { warmth_ = 0.0; }

  /// Mean square of the force over that of the continuous rating; 1 is as warm as it may become.
  [[nodiscard]] double warmth() const noexcept { return warmth_; }

 private:
  static constexpr double folds_from = 0.75;

  ThermalLimit(double continuous_N, double kept) : continuous_N_(continuous_N), kept_(kept) {}

  double continuous_N_;
  double kept_;  ///< of the warmth, over a tick
  double warmth_ = 0.0;
};

}  // namespace tactus::control
