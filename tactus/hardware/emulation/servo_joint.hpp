// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

/// Peers that speak as motors do, written from their makers' pages and not from the drivers.
namespace tactus::emulation {

/// A joint behind the gear of an emulated servo, free to turn: inertia, viscous drag and Coulomb friction of the gear.
///
///     J dv/dt = torque - b v - c sign(v),   at rest where |torque| <= c
///
/// Semi-implicit Euler of fixed steps, friction as an impulse that stops at most. Whatever is asked for later than ten
/// seconds after is as after ten: it has come to rest, or to its speed. Real-time safe.
class ServoJoint {
 public:
  double inertia_kg_m2 = 0.01;
  double drag_Nm_s_per_rad = 0.02;
  double friction_Nm = 0.02;

  /// The torque acted since the last call.
  void advance(std::int64_t now_ns, double torque_Nm) noexcept {
    now_ns_ = std::max(now_ns_, now_ns - longest_ns);
    if (velocity_rad_per_s == 0.0 && std::fabs(torque_Nm) <= friction_Nm) {
      now_ns_ += (now_ns - now_ns_) / step_ns * step_ns;  // it stays where it is
      return;
    }
    const double kick = friction_Nm / inertia_kg_m2 * step_s;
    for (; now_ns_ + step_ns <= now_ns; now_ns_ += step_ns) {
      double v = velocity_rad_per_s + (torque_Nm - drag_Nm_s_per_rad * velocity_rad_per_s) / inertia_kg_m2 * step_s;
      v = std::fabs(v) <= kick ? 0.0 : v - std::copysign(kick, v);
      velocity_rad_per_s = v;
      position_rad += v * step_s;
    }
  }

  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;

 private:
  static constexpr std::int64_t step_ns = 100'000, longest_ns = 10'000'000'000;
  static constexpr double step_s = 1e-4;
  std::int64_t now_ns_ = 0;
};

}  // namespace tactus::emulation
