// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>

/// Connectors: massless elements between two ends.
///
/// One sign convention for all of them. The deflection is positive when the connector is stretched, and its force is
/// positive when it pulls its two ends together. A plain spring therefore gives +stiffness · deflection; the end at the
/// larger coordinate feels minus that force, the other end plus.
namespace tactus::mechanics {

/// How far a connector is stretched, and how fast it is being stretched further.
struct Stretch {
  double deflection_m = 0.0;
  double rate_m_per_s = 0.0;
};

/// Spring and damper side by side: F = k δ + b δ̇. No state.
class LinearSpring {
 public:
  struct Params {
    double stiffness_N_per_m = 39500.0;
    double damping_N_s_per_m = 3.6;
    static constexpr auto fields() {
      return List{field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, non_negative,
                        "Force per deflection."),
                  field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre, non_negative,
                        "Force per rate of deflection.")};
    }
  };
  using Input = Stretch;
  using Output = double;

  static Result<LinearSpring> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    return LinearSpring(params);
  }

  /// Force in N, positive when it pulls the ends together. Real-time safe.
  double step(const Stretch& stretch) noexcept {
    return params_.stiffness_N_per_m * stretch.deflection_m + params_.damping_N_s_per_m * stretch.rate_m_per_s;
  }

  void reset() noexcept {}

 private:
  explicit LinearSpring(const Params& params) : params_(params) {}
  Params params_;
};

/// The same spring and damper, `factor` times as firm.
constexpr LinearSpring::Params scaled(LinearSpring::Params params, double factor) noexcept {
  params.stiffness_N_per_m *= factor;
  params.damping_N_s_per_m *= factor;
  return params;
}

/// Spring that stiffens with the fifth power: F = k δ + k₅ c⁵ + b δ̇, c = δ clamped to ±`guard_m`. No state.
///
/// This is the operator in the controller's model (paper A, Table I): 3.125e13 N/m^5 · (2 mm)⁵ = 1 N holds the model's
/// slow deflection within 2 mm at the largest displayed force.
///
/// The guard is there because the force is held over a step. Against the damper alone a held spring is stable while its
/// tangent times dt/b stays below 2; the tangent is 5 k₅ δ⁴, and for 200 µs and 23 N s/m that ends near 6 mm: one
/// larger excursion would blow up. Within the guard the force is exact, beyond it the quintic part stays at its value
/// there.
class QuinticSpring {
 public:
  struct Params {
    double stiffness_N_per_m = 40.0;
    double quintic_stiffness_N_per_m5 = 3.125e13;
    double damping_N_s_per_m = 23.0;
    double guard_m = 5e-3;
    static constexpr auto fields() {
      return List{field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, non_negative,
                        "Force per deflection at small deflection (paper A, Table I: 40)."),
                  field("quintic_stiffness_N_per_m5", &Params::quintic_stiffness_N_per_m5, units::newton_per_metre5,
                        non_negative, "Force per fifth power of the deflection (paper A, Table I: 3.125e13)."),
                  field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre, non_negative,
                        "Force per rate of deflection (paper A, Table I: 23)."),
                  field("guard_m", &Params::guard_m, units::metre, positive,
                        "Deflection above which the quintic force stays constant, for numerical safety.")};
    }
  };
  using Input = Stretch;
  using Output = double;

  static Result<QuinticSpring> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    return QuinticSpring(params);
  }

  /// Force in N, positive when it pulls the ends together. Real-time safe.
  double step(const Stretch& stretch) noexcept {
    const double guarded_m = std::clamp(stretch.deflection_m, -params_.guard_m, params_.guard_m);
    const double squared = guarded_m * guarded_m;
    return params_.stiffness_N_per_m * stretch.deflection_m +
           params_.quintic_stiffness_N_per_m5 * squared * squared * guarded_m +
           params_.damping_N_s_per_m * stretch.rate_m_per_s;
  }

  void reset() noexcept {}

 private:
  explicit QuinticSpring(const Params& params) : params_(params) {}
  Params params_;
};

}  // namespace tactus::mechanics
