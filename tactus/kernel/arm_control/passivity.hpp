// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/arm_message.hpp>
#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/arm_control/tool_limit.hpp>
#include <tactus/kernel/control/architectures/time_domain_passivity.hpp>

#include <array>

namespace tactus::arm_control {

/// Whose energy is counted.
enum class PassivePort {
  none,    ///< nobody's
  joints,  ///< each joint's by itself
  tool     ///< all joints' together: the power of a force at the tool
};
constexpr auto enumerators(PassivePort) {
  return std::array{Enumerator{PassivePort::none, "none"}, Enumerator{PassivePort::joints, "joints"},
                    Enumerator{PassivePort::tool, "tool"}};
}

struct PassivityLimit {
  double damping_N_m_s_per_rad = 0.0;
  static constexpr auto fields() {
    return List{field("damping_N_m_s_per_rad", &PassivityLimit::damping_N_m_s_per_rad,
                      arm::units::newton_metre_second_per_radian, between(0.0, 50.0),
                      "Largest damping of the joint. The damping torque may be larger only as far as it cancels a "
                      "displayed torque in the direction of motion.")};
  }
};

/// The group `[control.passivity]`.
struct PassivityParams {
  PassivePort port = PassivePort::none;
  EachJoint<PassivityLimit> joint_limits{{5.0}, {5.0}, {3.0}, {3.0}, {0.5}, {0.5}, {0.5}, {0.5}};
  double tool_limit_N_s_per_m = 30.0;
  double recovery_time_s = 0.05;
  static constexpr auto fields() {
    using P = PassivityParams;
    return List{
        field("port", &P::port,
              "Where the energy of the link is counted. No more energy may leave the link at one site than has entered "
              "it at the other. none: nowhere, without dampers. joints: at each joint separately. tool: at all joints "
              "together, by the power at the tool."),
        field("joint_limits", &P::joint_limits, "Only with the port joints: the limits of each joint."),
        field("tool_limit_N_s_per_m", &P::tool_limit_N_s_per_m, tactus::units::newton_second_per_metre,
              between(0.0, 1000.0),
              "Only with the port tool: largest damping at the leader's tool. The damping force may be larger only as "
              "far as it cancels a displayed force in the direction of motion."),
        field(
            "recovery_time_s", &P::recovery_time_s, tactus::units::second, between(0.002, 10.0),
            "Time constant with which the follower corrects the position error that its passivity controller causes.")};
  }
};

/// What a follower knows of the leader's half.
struct PassivityCoupling {
  PassivityParams params = {};
  double gain = 1.0;
};

/// The leader's half of time-domain passivity control of two arms: `control::PassivityMaster` for several joints, whose
/// docstring has the law. With `joints` each joint is a pair of ports by itself and its damper the joint's. With
/// `tool` there is one pair: its power is that of all joints, τᵀq̇, which is Fᵀẋ of a force at the tool, and its
/// damper is at the tool, τ = −Jᵀ·α·J·q̇. Energies are in the follower's scale: torque over the force gain.
///
/// A command acts between the tick after its reading and the next one, as on a bus. So a step of the leader is the
/// work of the torque of two ticks before. What a damper takes is known two ticks late, and a sampled damper is late
/// too: hence the limits.
///
/// Sources: those of `control::PassivityMaster`; of the power at the tool, C. Preusche, G. Hirzinger, J.-H. Ryu,
/// B. Hannaford, Time domain passivity control for 6 degrees of freedom haptic displays, IROS 2003.
class PassiveLeader {
 public:
  /// Counts nothing where `force_gain` is 0: no force, no energy.
  PassiveLeader(const PassivityParams& params, double force_gain, int joints, Seconds dt);

  [[nodiscard]] bool counts() const noexcept { return port_ != PassivePort::none; }
  /// What is added to `displayed`, the torque in N m that comes from the follower; `tool` is the Jacobian of the tool's
  /// point. Once a tick. Real-time safe.
  JointVector brake(const ArmReading& now, const JointVector& displayed, const JointVector& other_in_J,
                    const ToolJacobian& tool) noexcept;
  /// What passed to the motors of the latest sum of both. Real-time safe.
  void applied(const JointVector& displayed) noexcept { sent_.applied = displayed; }
  /// What flowed into the line here so far, in J; with `tool` all of it in the first number.
  [[nodiscard]] const JointVector& in_J() const noexcept { return in_J_; }

 private:
  [[nodiscard]] JointVector joint_brake(Eigen::Index joint, double lack_J, const JointVector& velocity,
                                        const JointVector& displayed) const noexcept;
  [[nodiscard]] JointVector tool_brake(double lack_J, const JointVector& velocity, const JointVector& displayed,
                                       const ToolJacobian& tool) const noexcept;

  struct Torques {
    JointVector displayed, applied;
  };
  PassivePort port_;
  JointVector joint_limits_;
  double tool_limit_N_s_per_m_;
  double energy_scale_;  ///< of the line over the leader's motors
  double dt_s_;
  bool started_ = false;
  JointVector before_;
  Torques acting_;  ///< since the last tick
  Torques sent_;    ///< act from now on
  Joints<control::PortObserver> ports_;
  JointVector in_J_;
};

/// The follower's half (`control::PassivitySlave`): it lags behind what the leader wants where that would take more
/// energy out of the line than went in.
class PassiveFollower {
 public:
  /// Counts nothing where the leader's force gain is 0: without force no energy would ever come, and it not move.
  PassiveFollower(const PassivityCoupling& coupling, int joints, Seconds dt);

  [[nodiscard]] bool counts() const noexcept { return port_ != PassivePort::none; }
  /// Moves what the leader wants to where the follower may go. `told` is the torque in N m from outside that was sent
  /// last. Once a tick. Real-time safe.
  void hold_back(ArmMessage& wanted, const JointVector& told) noexcept;
  /// As of the leader.
  [[nodiscard]] const JointVector& in_J() const noexcept { return in_J_; }

 private:
  PassivePort port_;
  double dt_s_;
  double recovery_per_tick_;
  bool started_ = false;
  JointVector before_;
  JointVector wanted_;
  Joints<control::PortObserver> ports_;
  JointVector in_J_;
};

}  // namespace tactus::arm_control
