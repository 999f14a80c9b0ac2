#pragma once

#include <algorithm>
#include <cmath>

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
/// Trans. Robotics 21(5), 2005. Diolaiti et al., IEEE Trans. Robotics 22(2), 2006, treat the same three effects by
/// describing functions; their finer regions are not here.
constexpr double quantised_stiffness_N_per_m(double damping_N_s_per_m, double tick_s, double friction_N,
                                             double resolution_m) {
  const double sampled = 2.0 * damping_N_s_per_m / tick_s;
  return resolution_m > 0.0 ? std::min(sampled, 2.0 * friction_N / resolution_m) : sampled;
}

/// Stable, and not more, with a wall that answers a delay t_d late: K < (b + B) / (T/2 + t_d), for delays small beside
/// m / (b + B).
/// Source: Gil, Sánchez, Hulin, Preusche, Hirzinger, Stability boundary for haptic rendering: influence of damping and
/// delay, J. Computing and Information Science in Engineering 9(1), 2009.
constexpr double stable_stiffness_N_per_m(double damping_N_s_per_m, double virtual_damping_N_s_per_m, double tick_s,
                                          double delay_s) {
  return (damping_N_s_per_m + virtual_damping_N_s_per_m) / (0.5 * tick_s + delay_s);
}

}  // namespace tactus::stability
