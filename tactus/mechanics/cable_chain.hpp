#pragma once

#include <tactus/core/element.hpp>
#include <tactus/mechanics/bodies.hpp>
#include <tactus/mechanics/elasto_slip.hpp>
#include <tactus/mechanics/springs.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactus::mechanics {

/// The grip of nobody: no spring, no damper.
inline constexpr LinearSpring::Params nobody_holds{.stiffness_N_per_m = 0.0, .damping_N_s_per_m = 0.0};

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
      return std::tuple{field("motor", &Params::motor, "Motor rotor (paper A, Table I)."),
                        field("cable", &Params::cable, "Cable between motor and drum (paper A, Table I)."),
                        field("drum", &Params::drum, "Drum (paper A, Table I)."),
                        field("linkage", &Params::linkage, "Linkage between drum and tip, with hysteresis."),
                        field("tip", &Params::tip, "Handle of the master or tool of the slave (paper A, Table I).")};
    }
  };

  struct Input {
    double motor_force_N = 0.0;          ///< on the motor, positive toward the environment
    double tip_force_N = 0.0;            ///< on the tip from outside, positive toward the environment
    double grip_position_m = 0.0;        ///< where the grip pulls the tip to, at the middle of the step
    double grip_velocity_m_per_s = 0.0;  ///< its velocity, at the middle of the step
  };

  struct Output {
    double motor_position_m = 0.0;
    double tip_position_m = 0.0;
    double grip_force_N = 0.0;  ///< of the grip on the tip, mean over the step, positive toward the environment
  };

  /// Everything that moves, from the motor outward.
  struct State {
    std::array<double, 3> position_m{};
    std::array<double, 3> velocity_m_per_s{};
    ElastoSlipSpring linkage;
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
    const double grip_force_N = advance(input, step_);
    return {
        .motor_position_m = state_.position_m[0], .tip_position_m = state_.position_m[2], .grip_force_N = grip_force_N};
  }
  /// Advances by any `duration_s` from 0 to the step that `make` was given: the part of a step up to an event.
  void advance(const Input& input, double duration_s) noexcept { advance(input, step_of(duration_s)); }

  /// Holds the tip through another grip from now on. Real-time safe. `grip` must be within its bounds and its stiffness
  /// one that `check_step` allows.
  void hold(const LinearSpring::Params& grip) noexcept {
    grip_ = grip;
    step_ = step_of(step_.h_s);
  }

  /// At rest at the origin, the linkage relaxed.
  void reset() noexcept { reset(0.0); }
  /// At rest with every mass at `position_m`, the linkage relaxed.
  void reset(double position_m) noexcept;

  [[nodiscard]] const State& state() const noexcept { return state_; }
  /// Goes back, or over, to `state`, which must come from this chain or an equal one.
  void set_state(const State& state) noexcept { state_ = state; }
  [[nodiscard]] double motor_position_m() const noexcept { return state_.position_m[0]; }
  [[nodiscard]] double tip_position_m() const noexcept { return state_.position_m[2]; }
  [[nodiscard]] double tip_velocity_m_per_s() const noexcept { return state_.velocity_m_per_s[2]; }

 private:
  /// All that depends on the length of a step. The matrix M + h/2 B is tridiagonal; the tip is eliminated first, so
  /// that what is left couples motor and drum alone.
  struct Step {
    double h_s, half_s;
    double cable_damping, linkage_damping, grip_damping;  ///< h/2 b of each
    double tip_on_drum, inverse_tip;      ///< the tip's row: h/2 b of the linkage, and 1, over its diagonal
    double i00, i01, i11;                 ///< the inverse of what is left
    double drum_on_motor, motor_on_drum;  ///< i01/i00 and i01/i11
    double motor_impulse, drum_impulse;   ///< the most that friction can give
  };

  [[nodiscard]] Step step_of(double duration_s) const noexcept;
  /// Returns the grip's force on the tip, mean over the step.
  double advance(const Input& input, const Step& step) noexcept;

  CableChain(const Params& params, const LinearSpring::Params& grip, Seconds dt, const ElastoSlipSpring& linkage);

  std::array<double, 3> mass_kg_;
  std::array<double, 2> friction_N_;
  LinearSpring::Params cable_;
  double linkage_damping_N_s_per_m_;
  LinearSpring::Params grip_;
  Step step_;
  State state_;
};

// In the header so that the plants' substeps, by far the most that a simulation computes, need no call.
inline double CableChain::advance(const Input& input, const Step& step) noexcept {
  auto& x = state_.position_m;
  auto& v = state_.velocity_m_per_s;
  for (std::size_t i = 0; i < 3; ++i) x[i] += step.half_s * v[i];

  const double cable_force = cable_.stiffness_N_per_m * (x[0] - x[1]);
  const double linkage_force = state_.linkage.step({.deflection_m = x[1] - x[2]});
  const double grip_force =
      grip_.stiffness_N_per_m * (input.grip_position_m - x[2]) + grip_.damping_N_s_per_m * input.grip_velocity_m_per_s;
  const double tip_velocity_before = v[2];

  // Momenta without friction, the damping's second half still to be taken out by the inverse.
  const double cable_damping = step.cable_damping * (v[0] - v[1]);
  const double linkage_damping = step.linkage_damping * (v[1] - v[2]);
  const double p0 = mass_kg_[0] * v[0] - cable_damping + step.h_s * (input.motor_force_N - cable_force);
  const double p1 = mass_kg_[1] * v[1] + cable_damping - linkage_damping + step.h_s * (cable_force - linkage_force);
  const double p2 = mass_kg_[2] * v[2] + linkage_damping - step.grip_damping * v[2] +
                    step.h_s * (linkage_force + grip_force + input.tip_force_N);

  // Each impulse is the clamp, to what friction can give, of what stops its mass while the other impulse acts. Put one
  // into the other: a line of slope below one through what stops both masses, clamped because the other impulse is. The
  // fixed point of a clamped line is the fixed point of the line, clamped alike. What stops both masses takes all their
  // momentum, so a mass at rest keeps exactly none.
  const auto impulse = [](double stops_both, double stops_alone, double reach_of_other, double most) {
    const double coupled = std::clamp(stops_both, stops_alone - reach_of_other, stops_alone + reach_of_other);
    return std::clamp(coupled, -most, most);
  };
  const double p1_dragged = p1 + step.tip_on_drum * p2;
  const double q0 = p0 + impulse(-p0, -(p0 + step.drum_on_motor * p1_dragged), step.drum_on_motor * step.drum_impulse,
                                 step.motor_impulse);
  const double q1 = p1_dragged + impulse(-p1_dragged, -(p1_dragged + step.motor_on_drum * p0),
                                         step.motor_on_drum * step.motor_impulse, step.drum_impulse);

  v[0] = step.i00 * q0 + step.i01 * q1;
  v[1] = step.i01 * q0 + step.i11 * q1;
  v[2] = step.inverse_tip * p2 + step.tip_on_drum * v[1];
  for (std::size_t i = 0; i < 3; ++i) x[i] += step.half_s * v[i];
  return grip_force - grip_.damping_N_s_per_m * 0.5 * (tip_velocity_before + v[2]);
}

}  // namespace tactus::mechanics
