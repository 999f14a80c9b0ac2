// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/control/stages/adaptive_cancellation.hpp>
#include <tactus/kernel/control/stages/cancellation.hpp>
#include <tactus/kernel/control/stages/stage.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactus::control {

/// Source of the firmness of the operator's grip for cancellation.
enum class OperatorEstimate {
  off,        ///< nowhere: the operator of the model is fixed, as in paper A
  online,     ///< from what the displayed force does to the motor
  scheduled,  ///< from a sensor of the grip
};
constexpr auto enumerators(OperatorEstimate) {
  return std::array{Enumerator{OperatorEstimate::off, "off"}, Enumerator{OperatorEstimate::online, "online"},
                    Enumerator{OperatorEstimate::scheduled, "scheduled"}};
}

/// The controller's model of the same master in a hand that holds it `grip` times as firmly. `grip` above 0.
///
/// Stiffness and damping of the hand go with the grip. The quintic limit k₅ goes with its tenth power, so that the slow
/// deflection it allows goes with grip⁻², and is left as it is for a grip above 1: the impact on a light hand lasts
/// longer and carries it further, and a limit within the reach of an impact makes it limp (docs/theory/changing-grip.md
/// measures this). The held quintic force is then no less stable than at grip 1.
MasterModel held(MasterModel model, double grip) noexcept;

/// Cancellation of induced master motion (see `Cancellation`) for a grip that changes (paper A, Sec. IX, which names
/// this as future work).
///
/// *Online*: `AdaptiveCancellation`, one model that follows the hand.
///
/// *Scheduled*: a bank of models of the same master in five hands, run side by side,
///
///     x̂_intended = x_m − Σ wᵢ x̂ᵢ,   wᵢ ≥ 0, Σ wᵢ = 1, toward its target with a time constant of 10 ms
///
/// where the target interpolates between the two hands next to the sensor's, on a logarithmic scale.
class GripCancellation {
 public:
  struct Params {
    Cancellation::Params cancellation;
    OperatorEstimate estimate = OperatorEstimate::off;
    static constexpr auto fields() {
      return List{field("cancellation", &Params::cancellation, "Cancellation with the nominal hand."),
                  field("estimate", &Params::estimate, "Where the grip is known from.")};
    }
  };
  struct Input {
    double measured_position_m = 0.0;  ///< of the motor, now
    double motor_force_N = 0.0;        ///< that acts from now to the next tick, positive toward the environment
    double grip = 1.0;                 ///< the sensor's, over nominal; used by `scheduled` alone
  };
  /// The motor position in m that the operator intended.
  using Output = double;

  /// The grips that the bank knows, over nominal. A sensor's below or above counts as the nearest.
  static constexpr std::array<double, 5> grips{0.25, 0.5, 1.0, 2.0, 4.0};

  /// A sensor of the grip that does not change leaves the weights of the bank as they are.
  static constexpr std::optional<Unfit> not_linear(const Params& params) {
    if (params.estimate != OperatorEstimate::online) return {};
    return Unfit{"estimate",
                 "an estimate that adapts to the loop is not linear: choose off, and try hands with operator.grip"};
  }
  static constexpr std::optional<Unfit> not_on_lanes(const Params& params) {
    if (params.cancellation.model.step != CancellationStep::exact)
      return Unfit{"cancellation.model.step", "write exact"};
    if (params.estimate != OperatorEstimate::off) return Unfit{"estimate", "write off"};
    return {};
  }

  static Result<GripCancellation> make(const Params& params, Seconds dt);

  /// The position in m that the operator intended, from the one measured now. Once a tick. A sensor's grip that is not
  /// a positive number counts as 1. Real-time safe.
  double intended(double measured_position_m, double grip) noexcept;
  /// What of the force `wanted_N` the hand is shown, in N, where no more than `limit_N` can be. Only `online` shows
  /// less (`AdmissibleForce`). Once a tick, before `intended`. Real-time safe.
  double admissible_N(double wanted_N, double limit_N) noexcept {
    if (estimate_ != OperatorEstimate::online) return wanted_N;
    return adaptive_.admissible_N(std::clamp(wanted_N, -limit_N, limit_N));
  }
  /// Advances the models to the next tick, under the force that really acts until then. Real-time safe.
  void advance(double motor_force_N) noexcept;
  /// Both at once.
  Output step(const Input& input) noexcept {
    const double intended_m = intended(input.measured_position_m, input.grip);
    advance(input.motor_force_N);
    return intended_m;
  }
  void reset() noexcept;

  /// Where the force so far has moved the motor, in m, at the instant of the last `intended`.
  [[nodiscard]] double induced_position_m() const noexcept { return induced_m_; }
  /// The grip that is cancelled for, over nominal. That of a bank is the mean of its weights on a logarithmic scale.
  [[nodiscard]] double grip() const noexcept;
  /// What is known of the hand. Only `online` estimates.
  [[nodiscard]] HandEstimate hand() const noexcept {
    return estimate_ == OperatorEstimate::online ? adaptive_.hand() : HandEstimate{};
  }

 private:
  static constexpr std::size_t nominal = 2;
  template <class T>
  using Each = std::array<T, grips.size()>;

  GripCancellation(OperatorEstimate estimate, const Each<InducedMotionModel>& models,
                   const signal::FilteredDerivative& intended_velocity, const AdaptiveCancellation& adaptive,
                   Seconds dt);

  void schedule(double grip) noexcept;

  OperatorEstimate estimate_;
  Each<InducedMotionModel> models_;
  signal::FilteredDerivative intended_velocity_;
  AdaptiveCancellation adaptive_;
  double weight_share_;  ///< of the way to their target that the weights take in a tick
  Each<double> weights_{0.0, 0.0, 1.0, 0.0, 0.0};
  double induced_m_ = 0.0;
  double intended_velocity_m_per_s_ = 0.0;
};

}  // namespace tactus::control
