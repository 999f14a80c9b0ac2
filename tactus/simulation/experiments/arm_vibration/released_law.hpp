// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/motors.hpp>
#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/core/parameters.hpp>

namespace tactus::experiments {

/// Of one joint, as openarm_teleop's configuration has it.
struct ReleasedJoint {
  double stiffness_N_m_per_rad = 0.0;
  double damping_N_m_s_per_rad = 0.0;
  double coulomb_N_m = 0.0;
  double turn_s_per_rad = 1.0;
  double viscous_N_m_s_per_rad = 0.0;
  double offset_N_m = 0.0;
  static constexpr auto fields() {
    using J = ReleasedJoint;
    namespace u = arm::units;
    return List{field("stiffness_N_m_per_rad", &J::stiffness_N_m_per_rad, Unit{"N m/rad", "_N_m_per_rad"},
                      between(0.0, 500.0), "Kp: stiffness of the drive toward the other arm's position."),
                field("damping_N_m_s_per_rad", &J::damping_N_m_s_per_rad, u::newton_metre_second_per_radian,
                      between(0.0, 5.0), "Kd: damping of the drive relative to the other arm's velocity."),
                field("coulomb_N_m", &J::coulomb_N_m, u::newton_metre, between(0.0, 10.0),
                      "Fc: Coulomb friction that the feed-forward compensates."),
                field("turn_s_per_rad", &J::turn_s_per_rad, Unit{"s/rad", "_s_per_rad"}, between(0.0, 1000.0),
                      "k: steepness with which this friction changes its sign at zero velocity, tanh(0.1 k v)."),
                field("viscous_N_m_s_per_rad", &J::viscous_N_m_s_per_rad, u::newton_metre_second_per_radian,
                      between(0.0, 10.0), "Fv: viscous friction that the feed-forward compensates."),
                field("offset_N_m", &J::offset_N_m, u::newton_metre, between(-10.0, 10.0),
                      "Fo: constant torque, added at rest and in motion.")};
  }
};

/// What openarm_teleop commands the drives of an arm, leader or follower alike:
///
///     stiffness·(other's position − q) + damping·(σ·other's velocity − q̇) + gravity(q) + Fc·tanh(0.1 k v) + Fv·v + Fo
///
/// where the first two are the drives' own law. σ is 1 as shipped.
/// Source: openarm_teleop (Apache-2.0), `bilateral_step` and `ComputeFriction`.
class ReleasedLaw {
 public:
  struct Params {
    arm_control::EachJoint<ReleasedJoint> joints = {};
    double velocity_share = 1.0;
    double friction_share = 1.0;
    static constexpr auto fields() {
      using P = Params;
      return List{field("joints", &P::joints,
                        "Gains and friction of each joint, with the values of config/leader.yaml of openarm_teleop."),
                  field("velocity_share", &P::velocity_share, tactus::units::none, between(0.0, 1.0),
                        "Share of the other arm's velocity in a drive's velocity target. 0: the drive damps its joint "
                        "toward zero velocity."),
                  field("friction_share", &P::friction_share, tactus::units::none, between(0.0, 2.0),
                        "Share of the feed-forward against friction that is commanded.")};
    }
  };

  /// Errors: a number out of bounds; those of `Chain::make`.
  static Result<ReleasedLaw> make(const Params& params, const arm::Chain::Params& arm);

  /// From what the host knows of this arm and of the other. Real-time safe.
  [[nodiscard]] arm::ArmCommand command(const arm::ArmReading& own, const arm::JointVector& other_position,
                                        const arm::JointVector& other_velocity) const noexcept;
  [[nodiscard]] const arm::JointVector& stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] const arm::JointVector& damping() const noexcept { return damping_; }

 private:
  ReleasedLaw(const Params& params, const arm::Chain& chain);

  arm::Chain chain_;
  Joints<ReleasedJoint> joints_;
  double velocity_share_;
  double friction_share_;
  arm::JointVector stiffness_;
  arm::JointVector damping_;
};

}  // namespace tactus::experiments
