// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/motors.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <cmath>

namespace tactus::arm_control {

/// Coulomb·tanh(v/v1) + viscous·v of a joint, in N m. Real-time safe.
inline double smooth_friction(const arm::JointFriction& friction, double v, double v1) noexcept {
  return friction.coulomb_N_m * std::tanh(v / v1) + friction.viscous_N_m_s_per_rad * v;
}

/// What a site gives a joint so that it moves as if it had no weight and less friction:
///
///     gravity(q) + share·(Coulomb·tanh(v/v1) + viscous·v)
///
/// v1 is wide, unlike the velocity in which real friction turns round, so that noise of the velocity makes no noise of
/// torque. Source: openarm_teleop (Apache-2.0), `ComputeFriction`, where v1 is 0.04 to 1.3 rad/s and share 1.
class FeedForward {
 public:
  struct Params {
    double friction_share = 1.0;
    double friction_velocity_rad_per_s = 0.3;
    static constexpr auto fields() {
      return List{field("friction_share", &Params::friction_share, units::none, between(0.0, 1.0),
                        "Share of the joints' friction that the motors compensate."),
                  field("friction_velocity_rad_per_s", &Params::friction_velocity_rad_per_s,
                        arm::units::radian_per_second, positive_up_to(10.0),
                        "Velocity v1 of the transition from one direction to the other: Coulomb friction F_c is "
                        "compensated as F_c tanh(v / v1).")};
    }
  };

  FeedForward(const Params& params, const arm::Chain::Params& arm, const arm::Chain& chain)
      : chain_(chain), friction_(member_of_each(arm.joints, &arm::JointParams::friction)), params_(params) {}

  /// In N m. Real-time safe.
  [[nodiscard]] arm::JointVector torque(const arm::ArmReading& reading) const noexcept {
    arm::JointVector torque = chain_.gravity_torque(reading.position);
    for (std::size_t i = 0; i < friction_.size(); ++i) {
      const auto joint = static_cast<Eigen::Index>(i);
      torque[joint] += params_.friction_share *
                       smooth_friction(friction_[i], reading.velocity[joint], params_.friction_velocity_rad_per_s);
    }
    return torque;
  }

 private:
  arm::Chain chain_;
  Joints<arm::JointFriction> friction_;
  Params params_;
};

}  // namespace tactus::arm_control
