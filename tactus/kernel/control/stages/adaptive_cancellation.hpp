// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/control/stages/admissible_force.hpp>
#include <tactus/kernel/control/stages/cancellation.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <array>
#include <cstddef>

namespace tactus::control {

/// Cancellation of induced master motion (see `Cancellation`) whose model follows the hand that holds the handle.
///
/// One model of the master, nonlinear as that of `Cancellation`, with two numbers that are estimated while a force is
/// displayed: the mobility θ₁ of the hand, 1 over its grip, so that stiffness and damping are k_o/θ₁ and b_o/θ₁, and
/// the share θ₂ by which the linkage is stiffer than identified. Alongside the model run the tangents
///
///     ξᵢ = ∂x/∂θᵢ,  driven by the force that a change of θᵢ adds:  (b_o v_h + k_o x_h)/θ₁²  on the handle,  the
///     linkage's force  between drum and handle
///
/// and a Kalman filter of the two numbers compares, above 40 Hz, where the operator does not move by intent, what was
/// measured with what the model states, e = H (x_m − x̂_m), whose slopes are H ξᵢ. Each number is a random walk drawn
/// back to what was identified (Ornstein and Uhlenbeck): without evidence it is forgotten, within 3 s for the hand and
/// 20 s for the linkage. What lies within the encoder's step is no evidence.
///
/// *A change moves nothing at once.* When θ changes by Δ, the state of the model goes along by Σ ξᵢ Δᵢ, as if the model
/// had had the new θ all the while, from the tick after on and as fast only as moves the command by one step of the
/// encoder, 10 µm, a tick.
/// The tangents forget slow motion (their common translation leaks away at 80 /s), so that a change of estimate
/// corrects the impact that showed it and not the centimetres that a hand was pushed before.
///
/// *Slow motion.* Instead of the quintic spring, which depends on size, a filter of frequency decides how much of the
/// modelled motion stays in the command (docs/theory/changing-grip.md derives the numbers):
///
///     x̂_intended = x_m − (1 − W) x̂_m,   W(s) = (0.1 + 0.9 · 3/(s + 3)) / (1 + s/(2π 15))
///
/// All below about 3 /s, where the operator takes the displacement out and subtracting it would be positive feedback; a
/// tenth up to 15 Hz, so that an estimate of the hand that is a tenth too light still does not feed back
/// positively; nothing above.
///
/// Starts with the identified hand. Sources: L. Ljung, System Identification, 2nd ed., 11.4 (recursive prediction
/// error); B. D. O. Anderson and J. B. Moore, Optimal Filtering, 8.2 (extended Kalman filter).
class AdaptiveCancellation {
 public:
  /// The quintic spring of the model's hand, and the stiffening of linear models, are left out. Errors: those of
  /// `Cancellation`; `inconsistent` for a model that is stepped by Euler.
  static Result<AdaptiveCancellation> make(const Cancellation::Params& params, Seconds dt);

  /// The position in m that the operator intended, from the one measured now. Once a tick. Real-time safe.
  double intended(double measured_position_m) noexcept;
  /// What of the force `wanted_N` this hand is shown, in N (`AdmissibleForce`). Once a tick, before `intended`.
  /// Real-time safe.
  double admissible_N(double wanted_N) noexcept { return force_.step(wanted_N, grip_); }
  /// Advances model and tangents to the next tick, under the force that really acts until then. Real-time safe.
  void advance(double motor_force_N) noexcept;
  void reset() noexcept;

  /// What was taken from the measured position at the last `intended`, in m.
  [[nodiscard]] double induced_position_m() const noexcept { return induced_m_; }
  /// How firmly the hand holds, over identified, from 1/6 to 6.
  [[nodiscard]] double grip() const noexcept { return grip_; }
  /// The estimate and how sure it is.
  [[nodiscard]] HandEstimate hand() const noexcept;

 private:
  static constexpr std::size_t mobility = 0, linkage = 1, parameters = 2;
  template <class T>
  using Each = std::array<T, parameters>;
  using Step = InducedMotionStep<double>;

  /// Passes what is fast. A change of estimate moves its states.
  struct HighPass {
    signal::SecondOrderSection<double> section;
    double step(double input) noexcept { return section.step(input); }
    void settle(double value) noexcept {
      section.state_1 = -section.b0 * value;
      section.state_2 = section.b2 * value;
    }
  };

  /// Of the two numbers; it is symmetric.
  struct Covariance {
    double mobility = 0.0, both = 0.0, linkage = 0.0;
  };

  AdaptiveCancellation(const InducedMotionModel& model, const MasterModel& master,
                       const signal::FilteredDerivative& intended_velocity, const signal::SecondOrderFilter& high_pass,
                       Seconds dt);

  // Inline where they are defined, in the source file: a tick calls each once.
  inline void weigh(double unexplained_m, const Each<double>& slope_m) noexcept;
  inline void apply() noexcept;
  inline double slow_part_m(double induced_m) noexcept;
  [[nodiscard]] inline Step::Difference difference() const noexcept;

  Step model_;
  bool hysteretic_;
  double hand_stiffness_N_per_m_, hand_damping_N_s_per_m_;
  double average_linkage_N_per_m_;
  double variance_m2_;            ///< of what a model leaves of a sample
  Each<double> forgotten_share_;  ///< of an estimate, in a tick
  Covariance kept_, regained_;    ///< in a tick without evidence: what is left of it, and what comes to it
  double washed_share_, person_share_, passed_share_;
  signal::FilteredDerivative intended_velocity_;

  Each<Step::State> tangent_{};
  HighPass residual_;
  Each<HighPass> slope_;
  Each<double> estimate_{}, pending_{};  ///< pending: found, not yet applied
  Covariance covariance_{};
  double grip_ = 1.0;  ///< 1 over the estimated mobility
  double person_m_ = 0.0, passed_m_ = 0.0;
  AdmissibleForce force_;
  bool primed_ = false;
  double induced_m_ = 0.0;
  double intended_velocity_m_per_s_ = 0.0;
};

}  // namespace tactus::control
