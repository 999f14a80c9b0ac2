// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/tool_coupling.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace tactus::arm_control {
namespace {

constexpr double turn_m_per_rad = 0.1;       ///< l: a radian of the tool counts as so many metres
constexpr double damping_m_per_rad = 0.005;  ///< λ
constexpr double return_per_s = 1.0;         ///< towards the first position, where the tool leaves it free
constexpr double least_volume = 1e-3;        ///< of three directions of length 1; 1 where they are square

Check check_axes(const arm::Matrix3& axes) {
  if (std::fabs(axes.determinant()) >= least_volume) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "joints",
               .message =
                   "the leader's three joints slide within a plane, so its handle leads no tool in space: turn "
                   "their axes",
               .place = {}};
}

}  // namespace

Result<arm::Matrix3> ToolCoupling::axes_of(const arm::Chain::Params& leader) {
  const auto chain = arm::Chain::make(leader);
  if (!chain) return chain.error();
  const auto sliding = std::count_if(leader.joints.begin(), leader.joints.end(), [](const arm::JointParams& joint) {
    return joint.kind == arm::JointKind::prismatic;
  });
  if (chain->joints() != 3 || sliding != 3) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "joints",
                 .message =
                     "a handle that leads a tool is three joints that slide, as of a haptic device along x, y "
                     "and z, and this leader has " +
                     std::to_string(chain->joints()) + " joints, of which " + std::to_string(sliding) +
                     " slide: describe the device so, or couple joint by joint",
                 .place = {}};
  }
  const arm::Matrix3 axes = chain->jacobian(JointVector::Zero(3), 2, arm::Vector3::Zero()).topRows<3>();
  if (Check wrong = check_axes(axes)) return *std::move(wrong);
  return axes;
}

Result<ToolCoupling> ToolCoupling::make(double scale, const arm::Matrix3& axes, const Arm& arm, Seconds dt) {
  if (arm.chain.joints() < 3) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "joints",
                 .message = "a tool that goes everywhere takes three joints, and the follower has " +
                            std::to_string(arm.chain.joints()) + ": take another arm",
                 .place = {}};
  }
  if (Check wrong = check_axes(axes)) return *std::move(wrong);
  return ToolCoupling(scale, axes, arm, dt);
}

ToolCoupling::ToolCoupling(double scale, const arm::Matrix3& axes, const Arm& arm, Seconds dt)
    : chain_(arm.chain),
      tool_m_(arm.tool_m),
      leads_(scale * axes),
      leads_inverse_(leads_.inverse()),
      lower_(arm.chain.joints()),
      upper_(arm.chain.joints()),
      fastest_(arm.chain.joints()),
      dt_s_(dt.value) {
  for (Eigen::Index i = 0; i < lower_.size(); ++i) {
    const arm::JointLimits& limits = arm.params.joints[static_cast<std::size_t>(i)].limits;
    lower_[i] = limits.lower_rad;
    upper_[i] = limits.upper_rad;
    fastest_[i] = limits.velocity_rad_per_s;
  }
}

ToolCoupling::Map ToolCoupling::map_at(const JointVector& position) const noexcept {
  const int last = chain_.joints() - 1;
  Map map{.jacobian = chain_.jacobian(position, last, tool_m_),
          .last = chain_.poses(position)[static_cast<std::size_t>(last)],
          .inverse = arm::JointMatrix::Identity(chain_.joints(), chain_.joints())};
  arm::JointMatrix squared = damping_m_per_rad * damping_m_per_rad * map.inverse;
  squared += map.moving().transpose().lazyProduct(map.moving());
  squared += turn_m_per_rad * turn_m_per_rad * map.turning().transpose().lazyProduct(map.turning());
  squared.llt().solveInPlace(map.inverse);
  return map;
}

arm::Vector3 ToolCoupling::tool_at(const arm::LinkPose& last) const noexcept {
  return last.rotation * tool_m_ + last.position_m;
}

JointVector ToolCoupling::slowed(const JointVector& velocity) const noexcept {
  double share = 1.0;
  for (Eigen::Index i = 0; i < velocity.size(); ++i) {
    const double speed = std::fabs(velocity[i]);
    if (speed > fastest_[i]) share = std::min(share, fastest_[i] / speed);
  }
  return share * velocity;
}

ArmMessage ToolCoupling::wanted(const ArmMessage& leader, const JointVector& position) noexcept {
  const arm::Vector3 handle = leader.position.head<3>();
  if (!engaged_) {
    const arm::LinkPose last = chain_.poses(position)[static_cast<std::size_t>(chain_.joints() - 1)];
    engaged_ = Engaged{.handle = handle,
                       .tool_m = tool_at(last),
                       .attitude = last.rotation,
                       .position = position,
                       .reference = position};
  }
  Engaged& from = *engaged_;
  const Map map = map_at(from.reference);
  const arm::Vector3 missing_m = from.tool_m + leads_ * (handle - from.handle) - tool_at(map.last);
  // Half of the sum of the axes' cross products: the turn that is missing, for small ones.
  arm::Vector3 missing_rad = arm::Vector3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    missing_rad += 0.5 * map.last.rotation.col(axis).cross(from.attitude.col(axis));
  }
  JointVector towards = damping_m_per_rad * damping_m_per_rad * return_per_s * dt_s_ * (from.position - from.reference);
  towards += map.moving().transpose().lazyProduct(missing_m);
  towards += turn_m_per_rad * turn_m_per_rad * map.turning().transpose().lazyProduct(missing_rad);
  const JointVector step = map.inverse.lazyProduct(towards);
  from.reference += dt_s_ * slowed(step / dt_s_);
  // A joint that is engaged beyond its range stays where it is, or comes back.
  from.reference = from.reference.cwiseMax(lower_.cwiseMin(from.position)).cwiseMin(upper_.cwiseMax(from.position));

  const arm::Vector3 velocity_m_per_s = leads_ * leader.velocity.head<3>();
  const JointVector moved = map.moving().transpose().lazyProduct(velocity_m_per_s);
  ArmMessage wanted = ArmMessage::at_rest(from.reference);
  wanted.velocity = slowed(map.inverse.lazyProduct(moved));
  return wanted;
}

ArmMessage ToolCoupling::told(const ArmReading& reading, const JointVector& external_torque) const noexcept {
  const Map map = map_at(reading.position);
  const arm::Vector3 moved_m = tool_at(map.last) - (engaged_ ? engaged_->tool_m : tool_at(map.last));
  const arm::Vector3 velocity_m_per_s = map.moving().lazyProduct(reading.velocity);
  const JointVector through = map.inverse.lazyProduct(external_torque);
  const arm::Vector3 force_N = map.moving().lazyProduct(through);
  const arm::Vector3 handle = engaged_ ? engaged_->handle : arm::Vector3(arm::Vector3::Zero());
  return {.position = handle + leads_inverse_ * moved_m,
          .velocity = leads_inverse_ * velocity_m_per_s,
          .external_torque = leads_.transpose() * force_N};
}

}  // namespace tactus::arm_control
