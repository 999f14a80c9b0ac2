// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

#include <numbers>

namespace tactus::stability {

/// What of the nonlinear device a linear model stands for.
struct Linearisation {
  /// Amplitude of the velocity at which Coulomb friction is replaced by its describing function, a damper of
  /// 4 f / (π V) to the ground, in m/s; 0 leaves friction out.
  double friction_speed_m_per_s = 0.0;
  /// Amplitude of the linkage's deflection whose chord is its stiffness, in m; 0 is the reference deflection, where the
  /// chord is the described average stiffness. The loss of the loop is left out.
  double linkage_amplitude_m = 0.0;
  /// Contact force about which a wall with a curved law is taken as straight, in N.
  double preload_N = 1.0;
  static constexpr auto fields() {
    return List{
        field("friction_speed_m_per_s", &Linearisation::friction_speed_m_per_s, units::metre_per_second, non_negative,
              "Velocity amplitude of the describing function of friction; 0 leaves friction out."),
        field("linkage_amplitude_m", &Linearisation::linkage_amplitude_m, units::metre, non_negative,
              "Deflection amplitude whose chord is the linkage's stiffness; 0 is the reference deflection."),
        field("preload_N", &Linearisation::preload_N, units::newton, positive,
              "Contact force about which the wall is linearised.")};
  }

  /// The damper to the ground that stands for Coulomb friction of `friction_N`, in N s/m.
  [[nodiscard]] constexpr double rubbing_N_s_per_m(double friction_N) const noexcept {
    return friction_speed_m_per_s > 0.0 ? 4.0 * friction_N / (std::numbers::pi * friction_speed_m_per_s) : 0.0;
  }
};

}  // namespace tactus::stability
