// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace tactus::control::test {

/// A mass with Coulomb friction, and a hand that holds it with a spring and a damper. Symplectic Euler, fine steps.
struct Device {
  double mass_kg = 0.03;
  double friction_N = 0.02;
  double spring_N_per_m = 0.0;
  double damper_N_s_per_m = 0.0;
  double drift_m_per_s = 0.0;  ///< of what the spring ends on
  double gain = 1.0;           ///< −1 is a motor that is wired the wrong way round
  double position_m = 0.0;
  double velocity_m_per_s = 0.0;
  double anchor_m = 0.0;

  /// One tick of 200 us under the motor's force and another.
  void push(double motor_N, double other_N = 0.0) {
    constexpr int substeps = 20;
    constexpr double dt_s = 200e-6 / substeps;
    for (int i = 0; i < substeps; ++i) {
      anchor_m += drift_m_per_s * dt_s;
      const double force_N = gain * motor_N + other_N - spring_N_per_m * (position_m - anchor_m) -
                             damper_N_s_per_m * (velocity_m_per_s - drift_m_per_s);
      const double free_m_per_s = velocity_m_per_s + force_N / mass_kg * dt_s;
      const double braked = friction_N / mass_kg * dt_s;
      velocity_m_per_s = free_m_per_s - std::clamp(free_m_per_s, -braked, braked);
      position_m += velocity_m_per_s * dt_s;
    }
  }
  /// What an encoder with counts of 10 um says.
  [[nodiscard]] double read_m() const { return 1e-5 * std::round(position_m / 1e-5); }
};

}  // namespace tactus::control::test
