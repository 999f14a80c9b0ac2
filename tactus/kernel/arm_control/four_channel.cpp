// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/four_channel.hpp>

#include <algorithm>

namespace tactus::arm_control {

FourChannel::FourChannel(const Params& params, Side side, double gain, const arm::Chain::Params& arm,
                         const arm::Chain& chain, Seconds dt)
    : chain_(chain),
      friction_({.friction_share = 1.0}, arm, chain),
      side_(side),
      of_own_((side == Side::leader ? 1.0 : gain) / std::max(1.0, gain)),
      of_other_((side == Side::leader ? gain : 1.0) / std::max(1.0, gain)),
      alpha_(params.alpha),
      beta_(params.beta),
      dt_s_(dt.value),
      stiffness_(params.joints.of(chain.joints(), &FourChannelJoint::stiffness_N_m_per_rad)),
      damping_(params.joints.of(chain.joints(), &FourChannelJoint::damping_N_m_s_per_rad)),
      observer_rad_per_s_(params.joints.of(chain.joints(), &FourChannelJoint::observer_rad_per_s)),
      force_share_(params.joints.of(chain.joints(), &FourChannelJoint::force_share)),
      disturbance_limit_(params.joints.of(chain.joints(), &FourChannelJoint::disturbance_limit_N_m)),
      disturbance_filter_(JointVector::Zero(chain.joints())),
      reaction_filter_(disturbance_filter_),
      disturbance_(disturbance_filter_),
      external_(disturbance_filter_) {}

FourChannel::Output FourChannel::step(const ArmReading& reading, const ArmMessage& other) noexcept {
  const JointVector own = chain_.mass_matrix(reading.position).diagonal();
  const JointVector others = chain_.mass_matrix(other.position).diagonal();
  const bool leads = side_ == Side::leader;
  const JointVector shared = alpha_ * (leads ? own : others) + beta_ * (leads ? others : own);
  const JointVector share = (leads ? alpha_ : 1.0) * own.cwiseQuotient(shared).cwiseProduct(force_share_);
  const JointVector gravity = chain_.gravity_torque(reading.position);
  const JointVector unmodelled = friction_.torque(reading) - gravity  // friction, and then Coriolis
                                 + chain_.bias(reading.position, reading.velocity) - gravity;

  Output output;
  output.torque = share.cwiseProduct(of_own_ * external_ + of_other_ * other.external_torque) + disturbance_;
  const JointVector torque = stiffness_.cwiseProduct(other.position - reading.position) +
                             damping_.cwiseProduct(other.velocity - reading.velocity) + output.torque;
  const JointVector momentum = observer_rad_per_s_.cwiseProduct(own).cwiseProduct(reading.velocity);
  const JointVector taken = dt_s_ * observer_rad_per_s_;
  disturbance_filter_ += taken.cwiseProduct(torque + momentum - disturbance_filter_);
  reaction_filter_ += taken.cwiseProduct(torque + momentum - unmodelled - reaction_filter_);
  disturbance_ = (disturbance_filter_ - momentum).cwiseMax(-disturbance_limit_).cwiseMin(disturbance_limit_);
  external_ = momentum - reaction_filter_;
  output.external = external_;
  return output;
}

}  // namespace tactus::arm_control
