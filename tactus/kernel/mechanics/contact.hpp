// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>

/// Unilateral contact: the force pushes the two bodies apart and never pulls.
namespace tactus::mechanics {

/// How deep a body is in the other, and how fast it goes deeper. Negative depth is a gap.
struct Penetration {
  double penetration_m = 0.0;
  double rate_m_per_s = 0.0;
};

/// The law of `KelvinVoigtContact`, a template on the scalar: a sweep evaluates it in lanes.
template <class Scalar>
constexpr Scalar kelvin_voigt_force_N(const Scalar& stiffness_N_per_m, const Scalar& damping_N_s_per_m,
                                      const Scalar& penetration_m, const Scalar& rate_m_per_s) noexcept {
  using std::max;
  const Scalar force_N = stiffness_N_per_m * penetration_m + damping_N_s_per_m * rate_m_per_s;
  return select(penetration_m > 0.0, max(Scalar(0.0), force_N), Scalar(0.0));
}

/// Spring and damper that cannot pull: F = max(0, k δ + b δ̇) for δ > 0, else 0. No state.
///
/// The plain sum would hold a leaving body back just before it is free. The clamp removes that; what stays is the jump
/// to b·δ̇ at first touch, which `HuntCrossleyContact` does not have. Passive: the part beyond the spring always opposes
/// the motion.
/// Source: for instance G. Gilardi and I. Sharf, Literature survey of contact dynamics modelling, Mech. Mach. Theory
/// 37, 2002.
class KelvinVoigtContact {
 public:
  struct Params {
    double stiffness_N_per_m = 40000.0;
    double damping_N_s_per_m = 2.0;
    static constexpr auto fields() {
      return List{field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, non_negative,
                        "Force per depth of penetration."),
                  field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre, non_negative,
                        "Force per rate of penetration.")};
    }
  };
  using Input = Penetration;
  using Output = double;

  static Result<KelvinVoigtContact> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    return KelvinVoigtContact(params);
  }

  /// Force in N that pushes the bodies apart, never negative. Real-time safe.
  double step(const Penetration& input) noexcept {
    return kelvin_voigt_force_N(params_.stiffness_N_per_m, params_.damping_N_s_per_m, input.penetration_m,
                                input.rate_m_per_s);
  }

  void reset() noexcept {}

 private:
  explicit KelvinVoigtContact(const Params& params) : params_(params) {}
  Params params_;
};

/// Hunt and Crossley's contact: F = k δ (δ/δ_ref)ⁿ⁻¹ · max(0, 1 + c δ̇) for δ > 0, else 0. No state.
///
/// The damping grows with depth, so the force starts and ends at zero and the restitution of slow impacts tends to 1,
/// as measured on real bodies. Written with the secant stiffness k at a reference depth δ_ref, because the coefficient
/// of δⁿ has a unit that changes with n. Passive for every c, since 1 + c δ̇ departs from 1 in the direction of δ̇.
/// Source: K. H. Hunt and F. R. E. Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl.
/// Mech. 42, 1975.
class HuntCrossleyContact {
 public:
  struct Params {
    double stiffness_N_per_m = 40000.0;
    double reference_penetration_m = 1e-4;
    double exponent = 1.5;
    double dissipation_s_per_m = 0.5;
    static constexpr auto fields() {
      return List{
          field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, non_negative,
                "Force over depth at the reference depth."),
          field("reference_penetration_m", &Params::reference_penetration_m, units::metre, positive,
                "Depth at which the stiffness is given."),
          field("exponent", &Params::exponent, units::none, between(1.0, 2.5),
                "Growth of the force with depth: 1 flat on flat, 1.5 sphere on flat (Hertz), more for conforming or "
                "soft bodies."),
          field("dissipation_s_per_m", &Params::dissipation_s_per_m, units::second_per_metre, non_negative,
                "c: the force of the spring is multiplied by 1 + c times the rate of penetration, at least by 0.")};
    }
  };
  using Input = Penetration;
  using Output = double;

  static Result<HuntCrossleyContact> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    return HuntCrossleyContact(params);
  }

  /// Force in N that pushes the bodies apart, never negative. Real-time safe.
  double step(const Penetration& input) noexcept {
    const double depth_m = std::max(0.0, input.penetration_m);
    return params_.stiffness_N_per_m * depth_m *
           std::pow(depth_m / params_.reference_penetration_m, params_.exponent - 1.0) *
           std::max(0.0, 1.0 + params_.dissipation_s_per_m * input.rate_m_per_s);
  }

  void reset() noexcept {}

 private:
  explicit HuntCrossleyContact(const Params& params) : params_(params) {}
  Params params_;
};

}  // namespace tactus::mechanics
