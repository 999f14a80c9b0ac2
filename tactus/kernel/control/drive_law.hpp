// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace tactus::control {

/// The law that a drive runs by itself, much faster than its bus and without its delay ("MIT mode" of Damiao's and many
/// others' motors), in addition to the commanded force:
///
///     stiffness·(position − its own) + damping·(velocity − its own)
///
/// Where both gains are 0 there is no law. In the joint's unit, as all of a site.
struct DriveLaw {
  double position_m = 0.0;
  double velocity_m_per_s = 0.0;
  double stiffness_N_per_m = 0.0;
  double damping_N_s_per_m = 0.0;

  [[nodiscard]] bool acts() const noexcept { return stiffness_N_per_m != 0.0 || damping_N_s_per_m != 0.0; }
  /// What it gives there, in N. Real-time safe, as all below.
  [[nodiscard]] double force_N(double at_m, double at_m_per_s) const noexcept {
    return stiffness_N_per_m * (position_m - at_m) + damping_N_s_per_m * (velocity_m_per_s - at_m_per_s);
  }
  /// The same targets with a share of the gains.
  [[nodiscard]] DriveLaw times(double share) const noexcept {
    DriveLaw part = *this;
    part.stiffness_N_per_m *= share;
    part.damping_N_s_per_m *= share;
    return part;
  }
};

/// What holds a joint where it is while its support comes in (`SupportCheck`): the force of a spring, and a damper for
/// the drive.
struct HoldingLaw {
  double force_N = 0.0;
  double damping_N_s_per_m = 0.0;

  [[nodiscard]] bool acts() const noexcept { return force_N != 0.0 || damping_N_s_per_m != 0.0; }
  /// Adds it to a force and a law. Real-time safe.
  void add_to(double& to_N, DriveLaw& law) const noexcept {
    to_N += force_N;
    const double damping = law.damping_N_s_per_m + damping_N_s_per_m;
    if (damping > 0.0) law.velocity_m_per_s *= law.damping_N_s_per_m / damping;
    law.damping_N_s_per_m = damping;
  }
};

/// Makes a command of a force and a law, which together want `wanted_N` where the motor is, one that gives `passed_N`
/// there. Force and gains keep one share, so none of them grows, and the drive continues by the same law, weaker. Where
/// what passes is no part of what is wanted, as when it falls no faster than a rate limit, it is a force alone.
inline void keep_part(double& force_N, DriveLaw& law, double wanted_N, double passed_N) noexcept {
  const double share = passed_N / wanted_N;
  if (share >= 0.0 && share <= 1.0) {
    force_N *= share;
    law = law.times(share);
  } else {
    force_N = passed_N;
    law = {};
  }
}

/// What a drive reports of its motor in addition to its position; zeros where it reports nothing.
struct DriveReport {
  double velocity_m_per_s = 0.0;
  double force_N = 0.0;  ///< that the motor gives to the joint, as the drive assumes, from its current
};
/// Whether a drive can mean it: a number, and not beyond what any motor does, in m/s or rad/s and in N or N m. Of a
/// single tick of 1e300 an observer would be lost for good.
inline bool can_be_told(double value) noexcept { return std::fabs(value) <= 1e6; }

}  // namespace tactus::control
