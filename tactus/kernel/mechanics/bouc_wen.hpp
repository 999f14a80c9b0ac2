// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/mechanics/springs.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::mechanics {

/// The arithmetic of a `BoucWenSpring`, apart from how parameters become its coefficients. A template on the scalar,
/// and made of nothing else: a sweep runs it in lanes.
template <class Scalar>
struct BoucWenMotion {
  Scalar sustained_N_per_m{};
  Scalar hysteretic_N_per_m{};
  Scalar slip_m{};
  Scalar deflection_m{};
  Scalar elastic_m{};

  /// Force in N at this deflection, without damping.
  Scalar step(const Scalar& to_deflection_m) noexcept {
    using std::copysign;
    using std::expm1;
    using std::fabs;
    using std::max;
    using std::min;
    const Scalar change_m = to_deflection_m - deflection_m;
    deflection_m = to_deflection_m;
    const Scalar direction = copysign(Scalar(1.0), change_m);
    const Scalar distance_m = fabs(change_m);
    Scalar along_m = direction * elastic_m;
    const Scalar back_m = min(distance_m, max(Scalar(0.0), -along_m));
    along_m = along_m + back_m;
    along_m = along_m - (slip_m - along_m) * expm1((back_m - distance_m) / slip_m);
    elastic_m = direction * along_m;
    return sustained_N_per_m * to_deflection_m + hysteretic_N_per_m * elastic_m;
  }
};

/// Bouc–Wen spring, the usual rival of `ElastoSlipSpring`:  F = K∞ δ + h K₀ z + b δ̇  with
/// dz/dδ = 1 − (|z|/d)·½(1 + sgn(z δ̇)), K∞ = (1 − h) K₀.
///
/// Of the family with exponent n and shape β, γ this is n = 1, β = γ: for it one increment of deflection has a closed
/// solution (first elastic down to z = 0, then exponential toward ±d), so the spring is exactly rate-independent and
/// any step size is exact; β = γ also keeps it passive. The textbook's Euler step of ż is neither.
///
/// The parameters are those of the elasto-slip spring, so either can be in the other's place; only the slip
/// deflection differs in meaning, because an exponential has no last slip.
///
/// `stiffness_N_per_m` is the tip-to-tip slope K of a closed loop of amplitude A = `reference_deflection_m`, in which z
/// swings between ±Z: K = K₀ (1 − h + h·Z/A), where Z = d·(1 − exp(−(2A − Z)/d)) is solved once in `make`. The loop's
/// area is 2 h K₀ (2d (A − Z) − Z²/2). With d = 0.65 times the elasto-slip spring's slip deflection, as the defaults
/// are, the two loops have the same area and lie within 1 % of the peak force of each other.
///
/// Its known fault, and why it is not the default: a small ripple on a constant force ratchets, because a minor loop
/// does not close.
/// Sources: Y.-K. Wen, Method for random vibration of hysteretic systems, J. Eng. Mech. Div. ASCE 102, 1976; S.
/// Erlicher and N. Point, Thermodynamic admissibility of Bouc–Wen type hysteresis models, C. R. Mécanique 332, 2004.
class BoucWenSpring {
 public:
  struct Params {
    double stiffness_N_per_m = 3950.0;
    double damping_N_s_per_m = 0.02;
    double hysteretic_fraction = 0.3;
    double slip_deflection_m = 6.5e-5;
    double reference_deflection_m = 2.5e-4;
    static constexpr auto fields() {
      return List{
          field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, non_negative,
                "Average stiffness: slope of the line between the two end points of the closed force-deflection loop "
                "whose amplitude is reference_deflection_m (the master's linkage: 3950, paper A, Table I)."),
          field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre, non_negative,
                "Viscous damping in parallel with the spring (the master's linkage: 0.02)."),
          field("hysteretic_fraction", &Params::hysteretic_fraction, units::none, between(0.0, 0.99),
                "Share of the small-deflection stiffness that is lost at large deflection; 0 is a linear spring."),
          field("slip_deflection_m", &Params::slip_deflection_m, units::metre, positive,
                "Deflection scale d of the slip: at a deflection of d from rest, 63 % of the hysteretic part has "
                "slipped."),
          field("reference_deflection_m", &Params::reference_deflection_m, units::metre, positive,
                "Amplitude of the closed force-deflection loop that defines the average stiffness (1 N on the master's "
                "linkage).")};
    }
  };
  using Input = Stretch;
  using Output = double;

  static Result<BoucWenSpring> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    const double ratio = params.reference_deflection_m / params.slip_deflection_m;
    BoucWenSpring spring;
    spring.motion_.slip_m = params.slip_deflection_m;
    const double kept = 1.0 - params.hysteretic_fraction + params.hysteretic_fraction * loop_tip(ratio) / ratio;
    const double initial_N_per_m = params.stiffness_N_per_m / kept;
    spring.motion_.sustained_N_per_m = (1.0 - params.hysteretic_fraction) * initial_N_per_m;
    spring.motion_.hysteretic_N_per_m = params.hysteretic_fraction * initial_N_per_m;
    spring.damping_N_s_per_m_ = params.damping_N_s_per_m;
    return spring;
  }

  /// Force in N, positive when it pulls the ends together. The element is at rest, force free, at zero deflection.
  /// Real-time safe.
  double step(const Stretch& stretch) noexcept {
    return motion_.step(stretch.deflection_m) + damping_N_s_per_m_ * stretch.rate_m_per_s;
  }

  void reset() noexcept {
    motion_.deflection_m = 0.0;
    motion_.elastic_m = 0.0;
  }

  /// K₀: the slope from rest and just after a reversal, in N/m.
  [[nodiscard]] double initial_stiffness_N_per_m() const noexcept {
    return motion_.sustained_N_per_m + motion_.hysteretic_N_per_m;
  }
  [[nodiscard]] const BoucWenMotion<double>& motion() const noexcept { return motion_; }

 private:
  BoucWenSpring() = default;

  /// Z/d for A/d: the root of ζ + expm1(ζ − 2a). The function is convex and positive at the start, so Newton's steps
  /// fall toward the root from above and cannot leave it.
  static double loop_tip(double a) {
    double tip = std::min(a, 1.0);
    for (int i = 0; i < 64; ++i) tip -= (tip + std::expm1(tip - 2.0 * a)) / (1.0 + std::exp(tip - 2.0 * a));
    return tip;
  }

  BoucWenMotion<double> motion_;
  double damping_N_s_per_m_ = 0.0;
};

}  // namespace tactus::mechanics
