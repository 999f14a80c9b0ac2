// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/arm_message.hpp>
#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/arm_control/feed_forward.hpp>
#include <tactus/kernel/core/parameters.hpp>

namespace tactus::arm_control {

/// Of a joint in four-channel control.
struct FourChannelJoint {
  double stiffness_N_m_per_rad = 0.0;
  double damping_N_m_s_per_rad = 0.0;
  double observer_rad_per_s = 15.0;
  double force_share = 0.0;
  double disturbance_limit_N_m = 0.0;
  static constexpr auto fields() {
    using J = FourChannelJoint;
    namespace u = arm::units;
    return List{field("stiffness_N_m_per_rad", &J::stiffness_N_m_per_rad, Unit{"N m/rad", "_N_m_per_rad"},
                      between(0.0, 500.0), "Kp of the drive, toward the other arm's position."),
                field("damping_N_m_s_per_rad", &J::damping_N_m_s_per_rad, u::newton_metre_second_per_radian,
                      between(0.0, 50.0), "Kd of the drive, toward the other arm's velocity."),
                field("observer_rad_per_s", &J::observer_rad_per_s, u::radian_per_second, positive_up_to(1000.0),
                      "Corner frequency of the disturbance observer and of the reaction-force observer."),
                field("force_share", &J::force_share, tactus::units::none, between(0.0, 10.0),
                      "Kf: gain on the sum of both sides' torques."),
                field("disturbance_limit_N_m", &J::disturbance_limit_N_m, u::newton_metre, between(0.0, 100.0),
                      "Largest torque that compensates a disturbance.")};
  }
};

/// Four-channel control with disturbance and reaction-force observers, of either arm, joint by joint:
///
///     torque = Kp·(q_o − q) + Kd·(q̇_o − q̇) + a·Kf·(r + r_o) + d + gravity,
///     y' = G·(x − y),  x = torque − gravity + G·J·q̇,  d = y − G·J·q̇ within its limit,
///     z' = G·(x − c − friction − z),  −r = z − G·J·q̇,
///
/// with the other arm's q_o, q̇_o, r_o; J the diagonal of the mass matrix; a = α·J_l/(α·J_l + β·J_f) at the leader and
/// J_f/(α·J_l + β·J_f) at the follower. r is the torque from outside as seen by its observer, d what undoes all that is
/// not J·q̈, so that in the end positions are equal and r + r_o = 0. The first two terms are the drives' own. r and d
/// are those of the tick before.
///
/// Gains as released for OpenArm. A gain g is ours: in place of r + r_o both sides have (r_l + g·r_f)/max(1, g) of
/// leader and follower, so torques balance at −r_l = g·r_f; released is 1. Released scales gravity and J by 1.6, which
/// corrects the masses of its URDF; here they are the model's. Friction is that of `FeedForward`. Source:
/// tokirobot/openarm_bilateral (Apache-2.0, 2025), `Control::DoControl` in src/controller/control.cpp,
/// src/controller/global.hpp, config/leader.yaml.
class FourChannel {
 public:
  struct Params {
    EachJoint<FourChannelJoint> joints{{250.0, 3.5, 15.0, 1.5, 11.5}, {220.0, 3.0, 15.0, 1.5, 11.5},
                                       {250.0, 4.0, 18.0, 1.5, 10.5}, {250.0, 4.0, 24.0, 2.7, 11.5},
                                       {25.0, 0.3, 15.0, 1.0, 7.0},   {28.0, 0.17, 16.0, 0.8, 7.0},
                                       {31.0, 0.3, 15.8, 1.0, 6.0},   {0.0, 0.0, 10.0, 0.0, 2.5}};
    double alpha = 1.0;
    double beta = 0.8;
    static constexpr auto fields() {
      return List{
          field("joints", &Params::joints, "Gains of each joint, of both arms."),
          field("alpha", &Params::alpha, tactus::units::none, positive_up_to(100.0),
                "Weight of the leader's joint inertia J_l in the factors by which both arms multiply force_share: "
                "alpha J_l / (alpha J_l + beta J_f) at the leader, J_f / (alpha J_l + beta J_f) at the follower."),
          field("beta", &Params::beta, tactus::units::none, positive_up_to(100.0),
                "Weight of the follower's joint inertia J_f in these factors.")};
    }
  };
  enum class Side { leader, follower };

  /// `gain` is 0 or more.
  FourChannel(const Params& params, Side side, double gain, const arm::Chain::Params& arm, const arm::Chain& chain,
              Seconds dt);

  struct Output {
    JointVector torque;    ///< over the bus alongside gravity compensation, N m
    JointVector external;  ///< r, for the other side, N m
  };
  /// Once a tick. Real-time safe.
  Output step(const ArmReading& reading, const ArmMessage& other) noexcept;

  [[nodiscard]] const JointVector& stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] const JointVector& damping() const noexcept { return damping_; }

 private:
  arm::Chain chain_;
  FeedForward friction_;  ///< with gravity
  Side side_;
  double of_own_;    ///< times r
  double of_other_;  ///< times r_o
  double alpha_;
  double beta_;
  double dt_s_;
  JointVector stiffness_;
  JointVector damping_;
  JointVector observer_rad_per_s_;
  JointVector force_share_;
  JointVector disturbance_limit_;
  JointVector disturbance_filter_;  ///< y
  JointVector reaction_filter_;     ///< z
  JointVector disturbance_;
  JointVector external_;
};

/// How a follower is coupled that takes part in it.
struct FourChannelCoupling {
  FourChannel::Params params = {};
  double gain = 1.0;
};

}  // namespace tactus::arm_control
