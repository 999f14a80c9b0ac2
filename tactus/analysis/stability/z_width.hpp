// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

/// The stiffest virtual wall that a device can display, in closed form: a first look before any model of the loop. All
/// stiffnesses in N/m, dampings in N s/m, times in s. Real-time safe.
namespace tactus::stability {

/// Passive for every hand: K < 2 (b − |B|) / T, b the device's own damping, B the wall's virtual one, sampled every T.
/// Source: Colgate and Brown, Factors affecting the Z-width of a haptic display, ICRA 1994.
constexpr double passive_stiffness_N_per_m(double damping_N_s_per_m, double virtual_damping_N_s_per_m, double tick_s) {
  const double size = virtual_damping_N_s_per_m < 0.0 ? -virtual_damping_N_s_per_m : virtual_damping_N_s_per_m;
  return std::max(0.0, 2.0 * (damping_N_s_per_m - size) / tick_s);
}

/// Passive with an encoder of step Δ on a device with Coulomb friction f_c: K ≤ min(2 b / T, 2 f_c / Δ). What sampling
/// makes of energy must go into the damper, what quantisation makes into friction. A step of 0 is an ideal encoder.
/// Source: Abbott and Okamura, Effects of position quantization and sampling rate on virtual-wall passivity, IEEE
/// Trans. Robotics 21(5), 2005.
constexpr double quantised_stiffness_N_per_m(double damping_N_s_per_m, double tick_s, double friction_N,
                                             double resolution_m) {
  const double sampled = 2.0 * damping_N_s_per_m / tick_s;
  return resolution_m > 0.0 ? std::min(sampled, 2.0 * friction_N / resolution_m) : sampled;
}

/// Stable, and not more, with a wall that answers a delay t_d late: K < (b + B) / (T/2 + t_d), for delays small
/// alongside m / (b + B). Source: Gil, Sánchez, Hulin, Preusche, Hirzinger, Stability boundary for haptic rendering:
/// influence of damping and delay, J. Computing and Information Science in Engineering 9(1), 2009.
constexpr double stable_stiffness_N_per_m(double damping_N_s_per_m, double virtual_damping_N_s_per_m, double tick_s,
                                          double delay_s) {
  return (damping_N_s_per_m + virtual_damping_N_s_per_m) / (0.5 * tick_s + delay_s);
}

/// What a device does on a virtual wall.
enum class WallBehaviour {
  rests,               ///< any motion dies away
  buzzes,              ///< motion dies down to a limit cycle of about a step of the encoder
  holds_small_motion,  ///< motion up to an amplitude dies away, larger motion grows
  grows,               ///< nothing holds small motion, and large motion grows
};

/// A body on a virtual spring that is sampled, held and read through an encoder, with the body's damper b and Coulomb
/// friction c. In the manner of describing functions: motion of amplitude A and frequency ω lasts where what the late
/// spring puts in is what damper and friction take out,
///
///     K N(A) sin ωτ = b ω + 4 c / (π A),   τ = T/2 + t_d
///
/// with N the describing function of the encoder's steps: 1 for A far above a step Δ, and K N A = 2 K Δ / π for motion
/// about the edge of one step, the worst of resting places. Large motion dies where b ≥ K τ, whatever friction does;
/// small motion cannot last where c ≥ K Δ / 2, whatever the frequency, since sin ωτ ≤ 1. Two answers make four regions.
///
/// The four regions are those that Diolaiti, Niemeyer, Barbagli, Salisbury, Stability of haptic rendering:
/// discretization, quantization, time delay, and Coulomb effects, IEEE Trans. Robotics 22(2), 2006, find from energy;
/// the equations above were derived again.
struct SampledWall {
  double stiffness_N_per_m = 0.0;  ///< K, above 0
  double damping_N_s_per_m = 0.0;  ///< b
  double friction_N = 0.0;         ///< c
  double resolution_m = 0.0;       ///< Δ; 0 is an ideal encoder
  double tick_s = 1e-3;            ///< T
  double delay_s = 0.0;            ///< t_d, from a sample to the force that answers it

  /// τ, by which the spring is late in the mean.
  [[nodiscard]] constexpr double lag_s() const noexcept { return 0.5 * tick_s + delay_s; }
  /// K up to which motion of any size dies down, to rest or to a buzz.
  [[nodiscard]] constexpr double stiffest_bounded_N_per_m() const noexcept { return damping_N_s_per_m / lag_s(); }
  /// K up to which friction holds the edge of a step.
  [[nodiscard]] constexpr double stiffest_held_N_per_m() const noexcept {
    return resolution_m > 0.0 ? 2.0 * friction_N / resolution_m : std::numeric_limits<double>::infinity();
  }
  /// K up to which any motion comes to rest.
  [[nodiscard]] constexpr double stiffest_at_rest_N_per_m() const noexcept {
    return std::min(stiffest_bounded_N_per_m(), stiffest_held_N_per_m());
  }
  [[nodiscard]] constexpr WallBehaviour behaviour() const noexcept {
    const bool bounded = stiffness_N_per_m <= stiffest_bounded_N_per_m();
    const bool held = stiffness_N_per_m <= stiffest_held_N_per_m();
    if (bounded) return held ? WallBehaviour::rests : WallBehaviour::buzzes;
    return held ? WallBehaviour::holds_small_motion : WallBehaviour::grows;
  }
  /// The amplitude in m from which motion of a body of `mass_kg` grows, A = 4 c / (π ω (K τ − b)) with ω² = K / m:
  /// for ωτ far below 1 and an amplitude far above a step. Infinite where all motion is bounded.
  [[nodiscard]] double growing_from_m(double mass_kg) const noexcept {
    const double gained = stiffness_N_per_m * lag_s() - damping_N_s_per_m;
    if (gained <= 0.0) return std::numeric_limits<double>::infinity();
    return 4.0 * friction_N / (std::numbers::pi * std::sqrt(stiffness_N_per_m / mass_kg) * gained);
  }
};

}  // namespace tactus::stability
