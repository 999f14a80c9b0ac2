// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/springs.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactus::mechanics {

/// Four parallel elasto-slip elements: each a spring of stiffness kᵢ in series with a slider that holds up to kᵢ·uᵢ.
///
/// The state is where the sliders are, zᵢ ← clamp(zᵢ, δ ± uᵢ), and the force of each is kᵢ (δ − zᵢ). That is the same
/// as the force form sᵢ ← clamp(sᵢ + kᵢ·Δδ, ±kᵢ·uᵢ), but it needs no previous deflection and gathers no round-off over
/// the millions of steps of a run. Templates on the scalar: a sweep runs it in lanes, whose type brings `min` and
/// `max`.
template <class Scalar>
struct ElastoSlipElements {
  static constexpr std::size_t count = 4;
  std::array<Scalar, count> stiffness_N_per_m{};
  std::array<Scalar, count> slip_m{};
  std::array<Scalar, count> slider_m{};

  /// Force in N of all elements at this deflection. Rate-independent.
  constexpr Scalar step(Scalar deflection_m) noexcept {
    using std::max;
    using std::min;
    Scalar force{};
    for (std::size_t i = 0; i < count; ++i) {
      slider_m[i] = min(max(slider_m[i], deflection_m - slip_m[i]), deflection_m + slip_m[i]);
      force = force + stiffness_N_per_m[i] * (deflection_m - slider_m[i]);
    }
    return force;
  }
};

/// Spring with rate-independent hysteresis: a spring that never slips alongside four elasto-slip elements (Iwan,
/// Maxwell-slip), and a viscous damper:  F = K∞ δ + Σ kᵢ (δ − zᵢ) + b δ̇.
///
/// Physical parameters. From rest the stiffness is K₀; a share h (`hysteretic_fraction`) of it slips away in four equal
/// parts, as the deflection passes 1/4, 1/2, 3/4 and all of `slip_deflection_m`; what is left is K∞ = (1 − h) K₀. The
/// backbone is thus a polygon inscribed in a curve that bends steadily from K₀ to K∞. At a reversal every element
/// sticks first and needs twice its slip to slip back, so the branches are the backbone doubled (Masing).
///
/// `stiffness_N_per_m` is the *average* stiffness K: the slope of the chord between the two tips of a closed loop of
/// amplitude A = `reference_deflection_m`. In such a loop element i swings through 2·kᵢ·min(A, uᵢ), wherever it
/// started, so K = K₀ (1 − h + h·Σ¼ min(1, uᵢ/A)), and K₀ follows from K. The loop's area, the energy lost a cycle, is
/// Σ 4 kᵢ uᵢ max(0, A − uᵢ). With h = 0 it is a linear spring.
///
/// Why not Bouc–Wen (`BoucWenSpring`, kept as the rival): elasto-slip closes its minor loops exactly (no creep under a
/// small force ripple on a constant force), costs clamps and no exponential, and is exact for any step size.
/// Sources: W. D. Iwan, A distributed-element model for hysteresis, J. Appl. Mech. 33, 1966; G. Masing, Eigenspannungen
/// und Verfestigung beim Messing, Proc. 2nd Int. Congr. Appl. Mech., 1926.
class ElastoSlipSpring {
 public:
  struct Params {
    double stiffness_N_per_m = 3950.0;
    double damping_N_s_per_m = 0.02;
    double hysteretic_fraction = 0.3;
    double slip_deflection_m = 1e-4;
    double reference_deflection_m = 2.5e-4;
    static constexpr auto fields() {
      return List{
          field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, non_negative,
                "Average stiffness: slope of the line between the two end points of the closed force-deflection loop "
                "whose amplitude is reference_deflection_m (the master's linkage: 3950, paper A, Table I)."),
          field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre, non_negative,
                "Viscous damping in parallel with the spring (the master's linkage: 0.02)."),
          field("hysteretic_fraction", &Params::hysteretic_fraction, units::none, between(0.0, 0.99),
                "Share of the small-deflection stiffness that is lost when all friction elements slip; 0 is a linear "
                "spring."),
          field("slip_deflection_m", &Params::slip_deflection_m, units::metre, positive,
                "Deflection from rest at which the last of the spring's four friction elements begins to slip."),
          field("reference_deflection_m", &Params::reference_deflection_m, units::metre, positive,
                "Amplitude of the closed force-deflection loop that defines the average stiffness (1 N on the master's "
                "linkage).")};
    }
  };
  using Input = Stretch;
  using Output = double;

  static Result<ElastoSlipSpring> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    constexpr auto count = ElastoSlipElements<double>::count;
    constexpr double share = 1.0 / static_cast<double>(count);
    ElastoSlipSpring spring;
    double kept = 1.0 - params.hysteretic_fraction;
    for (std::size_t i = 0; i < count; ++i) {
      spring.elements_.slip_m[i] = params.slip_deflection_m * share * static_cast<double>(i + 1);
      kept += params.hysteretic_fraction * share *
              std::min(1.0, spring.elements_.slip_m[i] / params.reference_deflection_m);
    }
    spring.initial_stiffness_N_per_m_ = params.stiffness_N_per_m / kept;
    spring.sustained_stiffness_N_per_m_ = (1.0 - params.hysteretic_fraction) * spring.initial_stiffness_N_per_m_;
    spring.elements_.stiffness_N_per_m.fill(params.hysteretic_fraction * share * spring.initial_stiffness_N_per_m_);
    spring.damping_N_s_per_m_ = params.damping_N_s_per_m;
    return spring;
  }

  /// Force in N, positive when it pulls the ends together. The element is at rest, force free, at zero deflection.
  /// Real-time safe.
  double step(const Stretch& stretch) noexcept {
    return sustained_stiffness_N_per_m_ * stretch.deflection_m + elements_.step(stretch.deflection_m) +
           damping_N_s_per_m_ * stretch.rate_m_per_s;
  }

  void reset() noexcept { elements_.slider_m = {}; }

  /// K₀: the slope from rest and just after every reversal, in N/m. A plant that steps its linear part exactly takes
  /// this slope into it and holds the rest, −Σ kᵢ zᵢ, over the step.
  [[nodiscard]] double initial_stiffness_N_per_m() const noexcept { return initial_stiffness_N_per_m_; }
  /// K∞: the slope once every element slips, in N/m.
  [[nodiscard]] double sustained_stiffness_N_per_m() const noexcept { return sustained_stiffness_N_per_m_; }
  /// The elements as they are: stiffnesses, slips and sliders.
  [[nodiscard]] const ElastoSlipElements<double>& elements() const noexcept { return elements_; }

 private:
  ElastoSlipSpring() = default;
  ElastoSlipElements<double> elements_;
  double initial_stiffness_N_per_m_ = 0.0;
  double sustained_stiffness_N_per_m_ = 0.0;
  double damping_N_s_per_m_ = 0.0;
};

}  // namespace tactus::mechanics
