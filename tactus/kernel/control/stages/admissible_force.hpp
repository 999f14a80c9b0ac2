// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::control {

/// How much of a force a hand is shown of which a controller has an estimate. Less than what is wanted for two reasons.
///
/// *The hand yields.* Below the linkage's resonance a force F moves a hand of damping b at F/b. Of what lasts longer
/// than an impact (a low-pass of 5 Hz) a hand that holds g < 1 times as firmly as the one that was identified is shown
/// g, so that slow motion is fed back no more strongly than by that one:
///
///     F = F_w − c · (the part of F_w that is also in its low-pass),   c → 1 − min(1, g)
///
/// within 50 ms to less and 0.3 s to more. An impact passes whole; no force changes its sign.
///
/// *Nothing explains what the hand does.* While impacts leave more of the measured motion than a model of this hand can
/// explain, the gain of the loop goes down: to u₀/u of what is wanted, where u is the RMS, over 20 ms, of what is left
/// above 40 Hz and u₀ = 50 µm; it comes back within a second. A model that fits leaves less than that 20 ms after a
/// touch.
///
/// Not an element: its inputs and requests come at different moments of a tick. Real-time safe.
class AdmissibleForce {
 public:
  explicit AdmissibleForce(double dt_s)
      : slow_share_(-std::expm1(-dt_s * 2.0 * std::numbers::pi * slow_below_Hz)),
        lessened_share_(dt_s / lessened_within_s),
        restored_share_(dt_s / restored_within_s),
        looked_at_share_(dt_s / looked_at_s),
        trusted_share_(dt_s / trusted_again_s) {}

  /// What of the measured motion above 40 Hz no model explained, in m. Once a tick.
  void observe(double unexplained_m) noexcept {
    unexplained_m2_ += looked_at_share_ * (unexplained_m * unexplained_m - unexplained_m2_);
    withheld_ -= trusted_share_ * withheld_;
    if (unexplained_m2_ > most_unexplained_m * most_unexplained_m) {
      withheld_ = std::max(withheld_, 1.0 - most_unexplained_m / std::sqrt(unexplained_m2_));
    }
  }
  /// What is shown of `wanted_N`, in N, to a hand that holds `grip` times as firmly as identified. Once a tick.
  double step(double wanted_N, double grip) noexcept {
    const double trusted_N = wanted_N * (1.0 - withheld_);
    const double yields = 1.0 - std::min(1.0, grip);
    lessened_ += (yields > lessened_ ? lessened_share_ : restored_share_) * (yields - lessened_);
    const double lasting_N =
        trusted_N > 0.0 ? std::clamp(slow_N_, 0.0, trusted_N) : std::clamp(slow_N_, trusted_N, 0.0);
    slow_N_ += slow_share_ * (trusted_N - slow_N_);
    return trusted_N - lessened_ * lasting_N;
  }
  void reset() noexcept { slow_N_ = lessened_ = unexplained_m2_ = withheld_ = 0.0; }

 private:
  static constexpr double slow_below_Hz = 5.0;
  static constexpr double lessened_within_s = 0.05, restored_within_s = 0.3;
  static constexpr double most_unexplained_m = 5e-5;
  static constexpr double looked_at_s = 0.02, trusted_again_s = 1.0;

  double slow_share_, lessened_share_, restored_share_, looked_at_share_, trusted_share_;  ///< in a tick
  double slow_N_ = 0.0;
  double lessened_ = 0.0;  ///< share of a lasting force that is not shown
  double unexplained_m2_ = 0.0;
  double withheld_ = 0.0;  ///< share of any force that is not shown
};

}  // namespace tactus::control
