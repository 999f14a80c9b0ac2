// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/mechanics/bodies.hpp>
#include <tactus/kernel/mechanics/elasto_slip.hpp>
#include <tactus/kernel/mechanics/springs.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactus::mechanics {

/// The grip of nobody: no spring, no damper.
inline constexpr LinearSpring::Params nobody_holds{.stiffness_N_per_m = 0.0, .damping_N_s_per_m = 0.0};

/// The arithmetic of a `CableChain`, apart from how parameters become its coefficients. A template on the scalar, and
/// made of nothing else: a sweep runs it in lanes.
template <class Scalar>
struct CableChainMotion {
  struct Input {
    Scalar motor_force_N{};
    Scalar tip_force_N{};
    Scalar grip_position_m{};
    Scalar grip_velocity_m_per_s{};
  };

  /// Everything that moves, from the motor outward.
  struct State {
    std::array<Scalar, 3> position_m{};
    std::array<Scalar, 3> velocity_m_per_s{};
    ElastoSlipElements<Scalar> linkage;
  };

  /// All that depends on the length of a step. The matrix M + h/2 B is tridiagonal; the tip is eliminated first, so
  /// that what is left couples motor and drum alone.
  struct Step {
    Scalar h_s, half_s;
    Scalar cable_damping, linkage_damping, grip_damping;  ///< h/2 b of each
    Scalar tip_on_drum, inverse_tip;      ///< the tip's row: h/2 b of the linkage, and 1, over its diagonal
    Scalar i00, i01, i11;                 ///< the inverse of what is left
    Scalar drum_on_motor, motor_on_drum;  ///< i01/i00 and i01/i11
    Scalar motor_impulse, drum_impulse;   ///< the most that friction can give
  };

  std::array<Scalar, 3> mass_kg{};
  std::array<Scalar, 2> friction_N{};
  Scalar cable_stiffness_N_per_m{}, cable_damping_N_s_per_m{};
  Scalar linkage_sustained_N_per_m{}, linkage_damping_N_s_per_m{};
  Scalar grip_stiffness_N_per_m{}, grip_damping_N_s_per_m{};
  Step step;  ///< of the whole substep
  State state;

  [[nodiscard]] Step step_of(const Scalar& duration_s) const noexcept;
  /// Returns the grip's force on the tip, mean over the step.
  Scalar advance(const Input& input, const Step& over) noexcept;
};

/// Lane by lane, one state or the other.
template <class Condition, class Scalar>
typename CableChainMotion<Scalar>::State select_state(const Condition& condition,
                                                      const typename CableChainMotion<Scalar>::State& yes,
                                                      const typename CableChainMotion<Scalar>::State& no) noexcept {
  auto state = no;
  for (std::size_t i = 0; i < 3; ++i) {
    state.position_m[i] = select(condition, yes.position_m[i], no.position_m[i]);
    state.velocity_m_per_s[i] = select(condition, yes.velocity_m_per_s[i], no.velocity_m_per_s[i]);
  }
  for (std::size_t i = 0; i < ElastoSlipElements<Scalar>::count; ++i) {
    state.linkage.slider_m[i] = select(condition, yes.linkage.slider_m[i], no.linkage.slider_m[i]);
  }
  return state;
}

/// The mechanism of a cable-driven device, as a plant: motor –cable– drum –linkage– tip (paper A, Figs. 2 and 10).
///
/// Three masses on a line, all translated to the hand. Motor and drum rub; the cable is a spring and damper, the
/// linkage a hysteretic spring; the tip (the handle of a master, the tool of a slave) carries an outer force and,
/// where a hand holds it, a spring and damper to a moving point, the *grip*.
///
/// One step of length h is position Verlet with implicit midpoint damping and a Moreau friction impulse:
///
///     x½ = x + h/2 v,   (M + h/2 B) v⁺ = (M − h/2 B) v + h F(x½) + p,   x⁺ = x½ + h/2 v⁺
///
/// with |p| ≤ h f on each rubbing mass, chosen so that a mass that can be held at v⁺ = 0 is held there exactly.
/// Second order where the motion is smooth, without numerical damping, without a friction smoothing parameter, and
/// the worst case costs what the usual case costs. The two impulses are coupled through the damping matrix (by about
/// h b / 2m, below 1 % here); they are found at once and exactly, without sweeps.
///
/// Stable as long as 4/h² M − K is positive definite, that is h < 2/ω of the stiffest mode (the cable: 480 Hz,
/// h < 0.6 ms), whatever the damping; `make` refuses a longer step. Accurate to 0.1 % in frequency for h ≤ 50 µs.
/// Sources: Hairer, Lubich, Wanner, *Geometric Numerical Integration*, I.1 (Verlet); Moreau 1988
/// (unilateral contact and dry friction in finite freedom dynamics).
class CableChain {
 public:
  struct Params {
    RubbingMass motor{.mass_kg = 0.0075, .friction_N = 0.01};
    LinearSpring::Params cable{.stiffness_N_per_m = 39500.0, .damping_N_s_per_m = 3.6};
    RubbingMass drum{.mass_kg = 0.01075, .friction_N = 0.0144};
    ElastoSlipSpring::Params linkage;
    FreeMass tip{.mass_kg = 0.014};
    static constexpr auto fields() {
      return List{field("motor", &Params::motor, "Motor rotor (paper A, Table I)."),
                  field("cable", &Params::cable, "Cable between motor and drum (paper A, Table I)."),
                  field("drum", &Params::drum, "Drum (paper A, Table I)."),
                  field("linkage", &Params::linkage, "Linkage between drum and tip, with hysteresis."),
                  field("tip", &Params::tip, "Handle of the master or tool of the slave (paper A, Table I).")};
    }
  };

  using Motion = CableChainMotion<double>;
  /// Forces on motor and tip from outside, positive toward the environment; where the grip pulls the tip to and its
  /// velocity, at the middle of the step.
  using Input = Motion::Input;
  using State = Motion::State;

  struct Output {
    double motor_position_m = 0.0;
    double tip_position_m = 0.0;
    double grip_force_N = 0.0;  ///< of the grip on the tip, mean over the step, positive toward the environment
  };

  /// A chain at rest at the origin that nobody holds. Fails where a value is out of bounds or where the step is too
  /// long for the stiffness.
  static Result<CableChain> make(const Params& params, Seconds dt);
  /// The same, held at the tip through `grip`.
  static Result<CableChain> make(const Params& params, const LinearSpring::Params& grip, Seconds dt);

  /// An error unless steps of `dt` are stable with the tip held by `tip_stiffness_N_per_m`. It names the stiffest
  /// connector, `tip_parameter` where that is the tip's. For `params` and `dt` within their bounds.
  static Check check_step(const Params& params, double tip_stiffness_N_per_m, std::string_view tip_parameter,
                          Seconds dt);

  /// Advances by the step that `make` was given. Real-time safe.
  Output step(const Input& input) noexcept {
    const double grip_force_N = motion_.advance(input, motion_.step);
    return {.motor_position_m = motor_position_m(), .tip_position_m = tip_position_m(), .grip_force_N = grip_force_N};
  }
  /// Advances by any `duration_s` from 0 to the step that `make` was given: the part of a step up to an event.
  void advance(const Input& input, double duration_s) noexcept { motion_.advance(input, motion_.step_of(duration_s)); }

  /// Holds the tip through another grip from now on. Real-time safe. `grip` must be within its bounds and its stiffness
  /// one that `check_step` allows.
  void hold(const LinearSpring::Params& grip) noexcept {
    motion_.grip_stiffness_N_per_m = grip.stiffness_N_per_m;
    motion_.grip_damping_N_s_per_m = grip.damping_N_s_per_m;
    motion_.step = motion_.step_of(motion_.step.h_s);
  }

  /// At rest at the origin, the linkage relaxed.
  void reset() noexcept { reset(0.0); }
  /// At rest with every mass at `position_m`, the linkage relaxed.
  void reset(double position_m) noexcept;

  [[nodiscard]] const Motion& motion() const noexcept { return motion_; }
  /// For what steps the chain itself, as a tip at a wall does.
  [[nodiscard]] Motion& motion() noexcept { return motion_; }
  [[nodiscard]] const State& state() const noexcept { return motion_.state; }
  /// Goes back, or over, to `state`, which must come from this chain or an equal one.
  void set_state(const State& state) noexcept { motion_.state = state; }
  [[nodiscard]] double motor_position_m() const noexcept { return motion_.state.position_m[0]; }
  [[nodiscard]] double tip_position_m() const noexcept { return motion_.state.position_m[2]; }
  [[nodiscard]] double tip_velocity_m_per_s() const noexcept { return motion_.state.velocity_m_per_s[2]; }

 private:
  explicit CableChain(const Motion& motion) : motion_(motion) {}

  Motion motion_;
};

template <class Scalar>
typename CableChainMotion<Scalar>::Step CableChainMotion<Scalar>::step_of(const Scalar& duration_s) const noexcept {
  const Scalar half = 0.5 * duration_s;
  const Scalar cable = half * cable_damping_N_s_per_m;
  const Scalar linkage = half * linkage_damping_N_s_per_m;
  const Scalar grip = half * grip_damping_N_s_per_m;
  const Scalar tip = mass_kg[2] + linkage + grip;
  const Scalar on_drum = linkage / tip;
  const Scalar motor = mass_kg[0] + cable;
  const Scalar drum = mass_kg[1] + cable + linkage - on_drum * linkage;
  const Scalar determinant = motor * drum - cable * cable;
  return {.h_s = duration_s,
          .half_s = half,
          .cable_damping = cable,
          .linkage_damping = linkage,
          .grip_damping = grip,
          .tip_on_drum = on_drum,
          .inverse_tip = 1.0 / tip,
          .i00 = drum / determinant,
          .i01 = cable / determinant,
          .i11 = motor / determinant,
          .drum_on_motor = cable / drum,
          .motor_on_drum = cable / motor,
          .motor_impulse = duration_s * friction_N[0],
          .drum_impulse = duration_s * friction_N[1]};
}

// In the header so that the plants' substeps, by far the most that a simulation computes, need no call.
template <class Scalar>
inline Scalar CableChainMotion<Scalar>::advance(const Input& input, const Step& over) noexcept {
  auto& x = state.position_m;
  auto& v = state.velocity_m_per_s;
  for (std::size_t i = 0; i < 3; ++i) x[i] += over.half_s * v[i];

  const Scalar cable_force = cable_stiffness_N_per_m * (x[0] - x[1]);
  const Scalar stretch = x[1] - x[2];
  const Scalar linkage_force = linkage_sustained_N_per_m * stretch + state.linkage.step(stretch);
  const Scalar grip_force =
      grip_stiffness_N_per_m * (input.grip_position_m - x[2]) + grip_damping_N_s_per_m * input.grip_velocity_m_per_s;
  const Scalar tip_velocity_before = v[2];

  // Momenta without friction, the damping's second half still to be taken out by the inverse.
  const Scalar cable_damping = over.cable_damping * (v[0] - v[1]);
  const Scalar linkage_damping = over.linkage_damping * (v[1] - v[2]);
  const Scalar p0 = mass_kg[0] * v[0] - cable_damping + over.h_s * (input.motor_force_N - cable_force);
  const Scalar p1 = mass_kg[1] * v[1] + cable_damping - linkage_damping + over.h_s * (cable_force - linkage_force);
  const Scalar p2 = mass_kg[2] * v[2] + linkage_damping - over.grip_damping * v[2] +
                    over.h_s * (linkage_force + grip_force + input.tip_force_N);

  // Each impulse is the clamp, to what friction can give, of what stops its mass while the other impulse acts. Put one
  // into the other: a line of slope below one through what stops both masses, clamped because the other impulse is. The
  // fixed point of a clamped line is the fixed point of the line, clamped alike. What stops both masses takes all their
  // momentum, so a mass at rest keeps exactly none.
  const auto impulse = [](const Scalar& stops_both, const Scalar& stops_alone, const Scalar& reach_of_other,
                          const Scalar& most) {
    const Scalar coupled = clamped<Scalar>(stops_both, stops_alone - reach_of_other, stops_alone + reach_of_other);
    return clamped<Scalar>(coupled, -most, most);
  };
  const Scalar p1_dragged = p1 + over.tip_on_drum * p2;
  const Scalar q0 = p0 + impulse(-p0, -(p0 + over.drum_on_motor * p1_dragged), over.drum_on_motor * over.drum_impulse,
                                 over.motor_impulse);
  const Scalar q1 = p1_dragged + impulse(-p1_dragged, -(p1_dragged + over.motor_on_drum * p0),
                                         over.motor_on_drum * over.motor_impulse, over.drum_impulse);

  v[0] = over.i00 * q0 + over.i01 * q1;
  v[1] = over.i01 * q0 + over.i11 * q1;
  v[2] = over.inverse_tip * p2 + over.tip_on_drum * v[1];
  for (std::size_t i = 0; i < 3; ++i) x[i] += over.half_s * v[i];
  return grip_force - grip_damping_N_s_per_m * 0.5 * (tip_velocity_before + v[2]);
}

}  // namespace tactus::mechanics
