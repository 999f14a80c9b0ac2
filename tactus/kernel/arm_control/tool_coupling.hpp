// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/arm_message.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <optional>

namespace tactus::arm_control {

/// What commands the follower.
enum class Coupling {
  joints,  ///< joint i of the leader joint i of the follower
  tool     ///< three joints of the leader that slide the follower's tool (`ToolCoupling`)
};
constexpr auto enumerators(Coupling) {
  return std::array{Enumerator{Coupling::joints, "joints"}, Enumerator{Coupling::tool, "tool"}};
}

/// Lets a leader of three joints that slide, such as a haptic device whose handle moves along x, y and z, command the
/// tool of an arm of other joints. It belongs to the follower's site, runs on its clock, and is the only part that
/// knows both: what is sent are the leader's three numbers, and three come back.
///
/// Engaged at its first tick, it leads the tool by `scale` times what the handle has moved since, along the axes of the
/// base, keeps the tool's attitude, and of what motion is left that of least speed towards the joints' first position.
/// Joint references q follow by one damped step of Newton a tick, never faster than the URDF lets a joint be, and never
/// beyond its range, or where it was engaged beyond that:
///
///     H·dq = Jᵀ·(p_wanted − p(q)) + l²·J_turnᵀ·(turn that is missing) + λ²·(share of the way to the first position),
///     H = JᵀJ + l²·J_turnᵀJ_turn + λ²·1,     reference velocity H⁻¹Jᵀ·scale·A·ẋ
///
/// with the tool's Jacobians J and J_turn, l = 0.1 m, λ = 0.005 m/rad, and A the directions of the leader's joints. At
/// a singular pose, or out of reach, the tool comes as near as it can, and no joint turns wildly.
///
/// External torque τ comes back as the force that does on the handle the work that τ does on the motion that the handle
/// commands: f = scale·Aᵀ·(H⁻¹Jᵀ)ᵀ·τ. That of a force F at the tool is scale·Aᵀ·F up to the damping, so at a scale of 2
/// it is twice as large; moments about the tool are not reported. Sources: Y. Nakamura, H. Hanafusa, Inverse kinematic
/// solutions with singularity robustness, 1986; C. Wampler, Manipulator inverse kinematic solutions based on vector
/// formulations and damped least-squares methods, 1986 (damped least squares); O. Khatib, A unified approach for motion
/// and force control of robot manipulators, 1987 (forces by the transpose of the map of motion).
class ToolCoupling {
 public:
  /// The follower's arm as its site assumes it, and where its tool is on the last link.
  struct Arm {
    const arm::Chain::Params& params;
    const arm::Chain& chain;
    arm::Vector3 tool_m = arm::Vector3::Zero();
  };

  /// Directions in which the joints of a leader move its handle, m per m, a column each, along the axes of its base.
  /// Errors: `inconsistent` unless they are three that slide, along three directions.
  static Result<arm::Matrix3> axes_of(const arm::Chain::Params& leader);

  /// `scale`: metres of the tool for one of the handle, above 0. `axes` as `axes_of` states. Errors: `inconsistent` for
  /// an arm of fewer than three joints, and for axes that are not three directions.
  static Result<ToolCoupling> make(double scale, const arm::Matrix3& axes, const Arm& arm, Seconds dt);

  /// Where the follower's joints shall be and how fast, at this tick; the external torque is 0. Of the leader the first
  /// three numbers count. The first call engages, where leader and follower are. Real-time safe.
  ArmMessage wanted(const ArmMessage& leader, const JointVector& position) noexcept;
  /// What the follower sends in the leader's three joints: where the handle would be for the tool to be where it is, in
  /// m and m/s, and the force in N. After `wanted`. Real-time safe.
  [[nodiscard]] ArmMessage told(const ArmReading& reading, const JointVector& external_torque) const noexcept;

 private:
  /// H⁻¹Jᵀ and its parts, at a position of the joints.
  struct Map {
    arm::Jacobian jacobian;
    arm::LinkPose last;
    arm::JointMatrix inverse;  ///< H⁻¹
    [[nodiscard]] auto moving() const { return jacobian.topRows<3>(); }
    [[nodiscard]] auto turning() const { return jacobian.bottomRows<3>(); }
  };
  struct Engaged {
    arm::Vector3 handle;  ///< the leader's joints, m
    arm::Vector3 tool_m;
    arm::Matrix3 attitude;
    JointVector position;
    JointVector reference;
  };

  ToolCoupling(double scale, const arm::Matrix3& axes, const Arm& arm, Seconds dt);
  [[nodiscard]] Map map_at(const JointVector& position) const noexcept;
  [[nodiscard]] arm::Vector3 tool_at(const arm::LinkPose& last) const noexcept;
  /// Slowed as a whole until no joint is faster than it may be.
  [[nodiscard]] JointVector slowed(const JointVector& velocity) const noexcept;

  arm::Chain chain_;
  arm::Vector3 tool_m_;
  arm::Matrix3 leads_;          ///< m of the tool for one of each of the leader's joints
  arm::Matrix3 leads_inverse_;  ///< and back
  JointVector lower_, upper_, fastest_;
  double dt_s_;
  std::optional<Engaged> engaged_;
};

}  // namespace tactus::arm_control
