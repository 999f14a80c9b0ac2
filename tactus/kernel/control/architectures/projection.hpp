// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/control/estimators/hand_force_observer.hpp>

/// Projection-based force reflection: the master displays at once only as much force as the hand holds.
namespace tactus::control {

/// What of a force is reflected at once.
struct ProjectionParams {
  double unconditional_fraction = 0.1;
  double negligible_force_N = 0.02;
  double hand_force_cutoff_Hz = 30.0;
  static constexpr auto fields() {
    return List{
        field("unconditional_fraction", &ProjectionParams::unconditional_fraction, units::none, between(0.0, 1.0),
              "alpha: share of the force that is displayed even if the hand does not resist it; 1 is position-force."),
        field("negligible_force_N", &ProjectionParams::negligible_force_N, units::newton,
              Bounds{.lower = 1e-6, .upper = 100.0},
              "Square root of epsilon. The part of the display that depends on the direction of the hand force fades "
              "to zero below this hand force."),
        field("hand_force_cutoff_Hz", &ProjectionParams::hand_force_cutoff_Hz, units::hertz, positive,
              "Low-pass of the estimate of the hand force; below 0.44 of the sample rate.")};
  }
};

/// The part in N of `force_N` that a hand force holds, both positive: hand toward, force away from the environment,
///
///     φ = clamp₀¹(f̂_h f_e / max(f̂_h², ε))·f̂_h.
///
/// In several axes this projects f_e on the direction of the hand force and cuts it to the hand force's length. In one
/// axis no direction remains but the sign: φ is f_e cut to what lies between 0 and f̂_h, so nothing where the two do not
/// oppose each other. Where |f̂_h| < √ε it is less, continuously down to nothing at f̂_h = 0. Always |φ| ≤ |f_e|.
/// Real-time safe.
double held_force_N(double force_N, double hand_force_N, double negligible_force_N) noexcept;

/// The master site: position-force control that displays
///
///     f_r = α f_e + (1 − α) φ(f_e, f̂_h),    f_e = sat(μ F_e),
///
/// with f̂_h of a `HandForceObserver`, whose mass and friction are the sums over the devices of `model`.
///
/// A hand that holds the handle still pushes with just f_r, so f̂_h is f_r after the observer's lag, and f_r then rises
/// from α f_e by itself: at the pace of the observer over α to all of f_e. A handle that nobody holds gives way, f̂_h
/// stays at zero, and only α f_e is displayed. So in one axis α is the gain of a fast transient and 1 that of a press.
/// With α = 0 a hand at rest would never feel a force: nothing begins the rise.
///
/// Since f_r lies between 0 and f_e, the force limit holds.
/// Sources: Polushin, Liu and Lung, Projection-based force reflection algorithm for stable bilateral teleoperation over
/// networks, IEEE Trans. Instrumentation and Measurement 57(9), 2008; the same, Stability of bilateral teleoperators
/// with projection-based force reflection algorithms, 2008. Theirs estimates the hand by a high-gain input observer.
class ProjectionMaster {
 public:
  struct Params {
    PositionForceMaster::Params position_force;
    ProjectionParams projection;
    static constexpr auto fields() {
      return List{
          field("position_force", &Params::position_force, "Command path, scales and limit, as in position-force."),
          field("projection", &Params::projection, "What of the force is reflected at once.")};
    }
  };
  using Input = MasterInput;
  using Output = MasterOutput;

  static Result<ProjectionMaster> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept {
    Output output = display_.respond(input);
    const double force_N = -output.motor_force_N;
    const double hand_N = hand_.estimate(input.motor_position_m);
    const double held_N = held_force_N(force_N, hand_N, projection_.negligible_force_N);
    output.motor_force_N = -(held_N + projection_.unconditional_fraction * (force_N - held_N));
    return output;
  }
  void applied(double motor_force_N) noexcept {
    display_.applied(motor_force_N);
    hand_.applied(motor_force_N);
  }
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  void reset() noexcept {
    display_.reset();
    hand_.reset();
  }

 private:
  ProjectionMaster(const ProjectionParams& projection, const PositionForceMaster& display,
                   const HandForceObserver& hand)
      : projection_(projection), display_(display), hand_(hand) {}

  ProjectionParams projection_;
  PositionForceMaster display_;
  HandForceObserver hand_;
};

}  // namespace tactus::control
