#pragma once

#include <tactus/core/element.hpp>
#include <tactus/mechanics/bodies.hpp>
#include <tactus/mechanics/elasto_slip.hpp>
#include <tactus/mechanics/springs.hpp>

#include <array>
#include <string_view>

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
/// the worst case costs what the usual case costs. The two impulses are coupled only through the damping matrix
/// (by about h b / 2m, below 1 % here), so two sweeps leave an error below 1e-6 of the impulse.
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
  Output step(const Input& input) noexcept;
  /// Advances by any `duration_s` from 0 to the step that `make` was given: the part of a step up to an event.
  void advance(const Input& input, double duration_s) noexcept;

  /// At rest at the origin, the linkage relaxed.
  void reset() noexcept { reset(0.0); }
  /// At rest with every mass at `position_m`, the linkage relaxed.
  void reset(double position_m) noexcept;

  [[nodiscard]] const State& state() const noexcept { return state_; }
  [[nodiscard]] double motor_position_m() const noexcept { return state_.position_m[0]; }
  [[nodiscard]] double tip_position_m() const noexcept { return state_.position_m[2]; }
  [[nodiscard]] double tip_velocity_m_per_s() const noexcept { return state_.velocity_m_per_s[2]; }

 private:
  /// The inverse of M + h/2 B for one step length, and how much of the others' momentum friction has to stop with that
  /// of a rubbing mass to hold it: rows divided by their diagonal.
  struct Inverse {
    double i00, i01, i02, i11, i12, i22;
    double motor_from_drum, motor_from_tip, drum_from_motor, drum_from_tip;
  };

  [[nodiscard]] Inverse invert(double duration_s) const noexcept;
  void advance(const Input& input, double duration_s, const Inverse& inverse) noexcept;

  CableChain(const Params& params, const LinearSpring::Params& grip, Seconds dt, const ElastoSlipSpring& linkage);

  std::array<double, 3> mass_kg_;
  std::array<double, 2> friction_N_;
  LinearSpring::Params cable_;
  double linkage_damping_N_s_per_m_;
  LinearSpring::Params grip_;
  double dt_s_;
  Inverse step_inverse_;
  State state_;
};

}  // namespace tactus::mechanics
