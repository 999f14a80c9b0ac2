// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/model/induced_motion_step.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/bodies.hpp>
#include <tactus/kernel/mechanics/bouc_wen.hpp>
#include <tactus/kernel/mechanics/springs.hpp>

#include <array>

namespace tactus::control {

/// How the model is advanced from one servo tick to the next.
enum class CancellationStep {
  euler,  ///< forward Euler in substeps of at most 40 µs, as in paper A, Sec. VIII-B
  exact,  ///< the linear part by its matrix exponential, the nonlinear forces held over the tick
};
constexpr auto enumerators(CancellationStep) {
  return std::array{Enumerator{CancellationStep::euler, "euler"}, Enumerator{CancellationStep::exact, "exact"}};
}

/// How much of the mechanism the model distinguishes (paper A, Sec. VI and VII-A). The lower ones take links as rigid;
/// all but the last are linear.
enum class ModelFidelity {
  second_order,        ///< motor, drum and handle are one mass on the hand
  fourth_order,        ///< motor and drum are one mass, the handle another, the linkage between them
  sixth_order_linear,  ///< three masses
  sixth_order,         ///< three masses with friction, hysteresis of the linkage and the quintic hand
};
constexpr auto enumerators(ModelFidelity) {
  return std::array{Enumerator{ModelFidelity::second_order, "second-order"},
                    Enumerator{ModelFidelity::fourth_order, "fourth-order"},
                    Enumerator{ModelFidelity::sixth_order_linear, "sixth-order-linear"},
                    Enumerator{ModelFidelity::sixth_order, "sixth-order"}};
}

/// On which velocity the model's Coulomb friction acts.
enum class ModelFriction {
  at_rest,         ///< on the induced velocity alone, as if the hand rested: paper A's superposition
  total_velocity,  ///< on intended plus induced velocity, less the friction that the intended motion meets anyway
};
constexpr auto enumerators(ModelFriction) {
  return std::array{Enumerator{ModelFriction::at_rest, "at-rest"},
                    Enumerator{ModelFriction::total_velocity, "total-velocity"}};
}

/// The controller's parameters of master and hand, translated to the hand. The defaults are paper A's Table I.
struct MasterModel {
  mechanics::RubbingMass motor{.mass_kg = 0.0075, .friction_N = 0.01};
  mechanics::LinearSpring::Params cable{.stiffness_N_per_m = 39500.0, .damping_N_s_per_m = 3.6};
  mechanics::RubbingMass drum{.mass_kg = 0.01075, .friction_N = 0.0144};
  mechanics::BoucWenSpring::Params linkage;
  mechanics::FreeMass handle{.mass_kg = 0.014};
  mechanics::QuinticSpring::Params hand;
  double linear_hand_stiffening = 10.0;
  static constexpr auto fields() {
    return List{field("motor", &MasterModel::motor, "Motor rotor."),
                field("cable", &MasterModel::cable, "Cable between motor and drum."),
                field("drum", &MasterModel::drum, "Drum."),
                field("linkage", &MasterModel::linkage, "Linkage between drum and handle, with hysteresis."),
                field("handle", &MasterModel::handle, "Handle."),
                field("hand", &MasterModel::hand, "Hand and arm of the operator, stiff for large slow deflections."),
                field("linear_hand_stiffening", &MasterModel::linear_hand_stiffening, units::none, between(1.0, 1000.0),
                      "Factor on the hand's stiffness in the linear models, which have no quintic spring. These models "
                      "underestimate slow deflections by about this factor.")};
  }
};

/// How far a displayed force moves the motor (paper A, eq. 2 and Fig. 10): six states, run by the controller.
///
/// Three masses on a line with the deflections from where they would be without the force,
///
///     m_m ẍ_m = F − k_c (x_m − x_d) − b_c (ẋ_m − ẋ_d) − friction f_m
///     m_d ẍ_d = k_c (x_m − x_d) + b_c (ẋ_m − ẋ_d) − linkage(x_d − x_h) − b_l (ẋ_d − ẋ_h) − friction f_d
///     m_h ẍ_h = linkage(x_d − x_h) + b_l (ẋ_d − ẋ_h) − k_o x_h − k_5 x_h⁵ − b_o ẋ_h
///
/// The quintic spring belongs to the controller, not to the hand: it holds the slow deflection to about 2 mm at full
/// force, a tenth of the real one, because the operator takes out slow deflections without help and an overestimate
/// would be positive feedback (Sec. VI and VIII-A).
///
/// The linear models leave out friction and quintic spring and have the linkage at its average stiffness. A linear hand
/// of stiffness k_o would let the motor go all the way, so theirs is κ k_o, κ = `linear_hand_stiffening`. The hand's
/// damper hides the stiffness above κ k_o / (2π b_o), 2.8 Hz by default; faster motion changes by 8 % at most. A rigid
/// link makes one body of two: with x = T q, T of ones and zeros, TᵀM T, TᵀB T and TᵀK T take the place of M, B and K,
/// and the states of the bodies in one are equal, bit for bit.
///
/// The linkage is hysteretic, as the paper's model was. Its law is Bouc and Wen's, not the elasto-slip law of the
/// simulated devices, so that no model is checked against itself. A `hysteretic_fraction` of 0 makes it linear, and the
/// tick cheaper.
///
/// Friction on total velocity: friction that the moving hand already saturates hardly changes with the force. With the
/// share s = clamp(w/w₀, ±1) of friction that the intended velocity w uses up, what the force can still change lies in
/// [−f (1 − s), f (1 + s)], and it acts to stop the total velocity. Below the band w₀ the intended velocity is noise,
/// and friction sticks exactly as at rest; with w = 0 the two kinds are the same.
///
/// The exact step: x⁺ = Φ x + Γ u with Φ = exp(A·dt), Γ its integral, and u the motor force, the frictions and the
/// quintic force and what the linkage lacks to its initial stiffness, held over the tick. Frictions are found at the
/// end velocity, for both rubbing masses at once and exactly (`ground_forces`); nothing iterates.
///
/// Forces and motion are positive toward the environment, so a displayed force F_f enters as −F_f.
class InducedMotionModel {
 public:
  struct Params {
    MasterModel master;
    ModelFidelity fidelity = ModelFidelity::sixth_order;
    CancellationStep step = CancellationStep::exact;
    ModelFriction friction = ModelFriction::total_velocity;
    double friction_band_m_per_s = 0.005;
    static constexpr auto fields() {
      return List{
          field("master", &Params::master, "Mass of master and hand."),
          field("fidelity", &Params::fidelity, "How much of them the model distinguishes."),
          field("step", &Params::step, "Integration method of the model."),
          field("friction", &Params::friction, "On which velocity Coulomb friction acts, in the model that has it."),
          field("friction_band_m_per_s", &Params::friction_band_m_per_s, units::metre_per_second, positive,
                "Intended velocity above which friction counts as saturated by it.")};
    }
  };

  struct Input {
    double motor_force_N = 0.0;              ///< applied until the next tick, positive toward the environment
    double intended_velocity_m_per_s = 0.0;  ///< of the master without the force; used by `total_velocity` alone
    double handle_force_N = 0.0;             ///< on the handle until the next tick, from outside, same sign
  };
  /// Position of the motor in m at the end of the tick, less where it would be without the force.
  using Output = double;

  /// Positions of motor, drum and handle in m, then their velocities in m/s.
  using State = std::array<double, 6>;

  /// Longest substep of the Euler step (paper A, Sec. VIII-B).
  static constexpr double euler_substep_s = 40e-6;

  /// Fails where a value is out of bounds or where the Euler step would be unstable.
  static Result<InducedMotionModel> make(const Params& params, Seconds dt);

  /// Advances by one tick. Real-time safe.
  Output step(const Input& input) noexcept;
  /// At rest, undeflected.
  void reset() noexcept {
    exact_.state = {};
    exact_.linkage.deflection_m = 0.0;
    exact_.linkage.elastic_m = 0.0;
  }

  /// Where the force so far has moved the motor, in m: belongs to the sample taken at this very instant, before the
  /// next force acts.
  [[nodiscard]] double motor_position_m() const noexcept { return exact_.state[0]; }
  [[nodiscard]] const State& state() const noexcept { return exact_.state; }

  /// The exact step as it is, for sweeps; `hysteretic` reports whether its linkage is.
  [[nodiscard]] const InducedMotionStep<double>& exact_step() const noexcept { return exact_; }
  [[nodiscard]] bool hysteretic() const noexcept { return hysteretic_; }

 private:
  using Column = InducedMotionStep<double>::Column;
  using FrictionRange = InducedMotionStep<double>::FrictionRange;

  InducedMotionModel(const Params& params, const mechanics::BoucWenSpring& linkage, Seconds dt);
  void precompute_exact_step();
  void precompute_friction();

  void step_euler(const Input& input, const FrictionRange& range) noexcept;

  Params params_;       ///< linear ones without what they lack
  std::size_t bodies_;  ///< that move on their own
  bool hysteretic_;
  int euler_substeps_;
  double euler_substep_s_;
  std::array<double, 3> euler_response_{};  ///< substep over mass of what motor, drum, handle move with
  InducedMotionStep<double> exact_;         ///< holds the state for both steps
};

}  // namespace tactus::control
