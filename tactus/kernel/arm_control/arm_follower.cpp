// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/arm_follower.hpp>
#include <tactus/kernel/arm_control/effort_limits.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>

namespace tactus::arm_control {

ArmFollower::ArmFollower(const Params& params, const Arm& arm, const arm::Chain& chain, const Observer& observer,
                         const WantedMotion& wanted_motion, const std::optional<ToolCoupling>& coupling,
                         const SiteTare& tare, Seconds dt)
    : chain_(chain),
      tool_m_(arm.tool_m),
      feed_forward_(params.feed_forward, arm.chain, chain),
      wanted_motion_(wanted_motion),
      observer_(observer),
      tool_coupling_(coupling),
      passivity_(arm.passivity, chain.joints(), dt),
      told_(JointVector::Zero(chain.joints())),
      most_(effort_limits(arm.chain)),
      observes_(params.torque == TorqueSource::observer),
      tare_(tare),
      bias_(params.torque == TorqueSource::observer ? params.observer.bias_distance_m : 0.0, arm.chain, dt),
      dead_band_(JointVector::Zero(chain.joints())),
      stiffness_(params.stiffness_share * params.gains.of(chain.joints(), &DriveGains::stiffness_N_m_per_rad)),
      damping_(params.gains.of(chain.joints(), &DriveGains::damping_N_m_s_per_rad)),
      stiffness_limit_(stiffness_, params.tool_stiffness_limit_N_per_m),
      damping_limit_(damping_, params.tool_damping_limit_N_s_per_m) {
  if (arm.four_channel) {
    four_channel_ = FourChannel(arm.four_channel->params, FourChannel::Side::follower, arm.four_channel->gain,
                                arm.chain, chain, dt);
    stiffness_ = four_channel_->stiffness();
    damping_ = four_channel_->damping();
  }
  for (Eigen::Index i = 0; i < dead_band_.size(); ++i) {
    dead_band_[i] =
        params.observer.dead_band_share * arm.chain.joints[static_cast<std::size_t>(i)].friction.coulomb_N_m;
  }
}

Result<ArmFollower::Observer> ArmFollower::make_observer(const TorqueObserverParams& params, const Arm& arm,
                                                         const arm::Chain& chain, Seconds dt) {
  if (params.joints == JointModel::rigid) {
    const auto rigid = ExternalTorqueObserver::make(params, chain, dt);
    if (!rigid) return rigid.error();
    return Observer(*rigid);
  }
  const auto elastic = ElasticTorqueObserver::make(params, arm.chain, arm.joint_stiffness_N_m_per_rad, dt);
  if (!elastic) return elastic.error();
  return Observer(*elastic);
}

Result<std::optional<ToolCoupling>> ArmFollower::make_coupling(const Params& params, const Arm& arm,
                                                               const arm::Chain& chain, Seconds dt) {
  if (params.coupling == Coupling::joints) return std::optional<ToolCoupling>();
  const auto refused = [](ErrorCode code, const char* why) {
    return Error{.code = code, .parameter = "coupling", .message = why, .place = {}};
  };
  if (arm.four_channel) {
    return refused(ErrorCode::inconsistent,
                   "tool: four-channel couples each joint with its own: write position-force or cancellation");
  }
  if (!arm.leader_axes) {
    return refused(ErrorCode::missing, "tool: where do the leader's joints slide? State them, or couple joints");
  }
  const auto made = ToolCoupling::make(params.tool_scale, *arm.leader_axes, {arm.chain, chain, arm.tool_m}, dt);
  if (!made) return under("coupling", made.error());
  return std::optional<ToolCoupling>(*made);
}

Result<ArmFollower> ArmFollower::make(const Params& params, const Arm& arm, Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  const auto chain = arm::Chain::make(arm.chain);
  if (!chain) return chain.error();
  const auto observer = make_observer(params.observer, arm, *chain, dt);
  if (!observer) return under("observer", observer.error());
  const auto wanted = WantedMotion::make(params.wanted_motion, params.feed_forward.friction_velocity_rad_per_s,
                                         {arm.chain, *chain, arm.tool_m}, dt);
  if (!wanted) return under("wanted_motion", wanted.error());
  const auto coupling = make_coupling(params, arm, *chain, dt);
  if (!coupling) return coupling.error();
  const auto& gains = params.gains;
  const auto tare = SiteTare::make(
      arm.tare, arm.chain, *chain,
      {.stiffness_N_m_per_rad = gains.of(chain->joints(), &DriveGains::stiffness_N_m_per_rad),
       .damping_N_m_s_per_rad = gains.of(chain->joints(), &DriveGains::damping_N_m_s_per_rad)},
      arm.lacking_N_m.size() == chain->joints() ? arm.lacking_N_m : JointVector::Zero(chain->joints()), dt);
  if (!tare) return under("tare", tare.error());
  return ArmFollower(params, arm, *chain, *observer, *wanted, *coupling, *tare, dt);
}

JointVector ArmFollower::excess_torque(const ArmReading& reading, const ArmMessage& leader) const noexcept {
  const ToolJacobian tool = chain_.jacobian(reading.position, chain_.joints() - 1, tool_m_).topRows<3>();
  arm::Vector3 excess_N = arm::Vector3::Zero();
  if (stiffness_limit_.limits()) {
    excess_N += stiffness_limit_.excess(tool) * (tool * (leader.position - reading.position));
  }
  if (damping_limit_.limits()) excess_N += damping_limit_.excess(tool) * (tool * (leader.velocity - reading.velocity));
  return tool.transpose() * excess_N;
}

void ArmFollower::leave_out_dead_band(JointVector& torque) const noexcept {
  for (Eigen::Index i = 0; i < torque.size(); ++i) {
    torque[i] -= std::clamp(torque[i], -dead_band_[i], dead_band_[i]);
  }
}

ArmFollower::Output ArmFollower::step(const ArmReading& reading, const JointVector& sensed,
                                      const ArmMessage& heard) noexcept {
  ArmMessage leader = heard;
  if (passivity_.counts()) passivity_.hold_back(leader, told_);
  if (tool_coupling_) leader = tool_coupling_->wanted(leader, reading.position);
  if (tare_.acts()) leader.position.array() += tare_.away_rad(reading);
  const JointVector& lacking = tare_.lacking_N_m();
  Output output;
  output.support = feed_forward_.torque(reading) + lacking;
  output.command = {.position = leader.position,
                    .velocity = leader.velocity,
                    .stiffness = stiffness_,
                    .damping = damping_,
                    .torque = output.support};
  if (stiffness_limit_.limits() || damping_limit_.limits()) {
    output.command.torque -= tare_.limit_share() * excess_torque(reading, leader);
  }
  output.message = {.position = reading.position, .velocity = reading.velocity, .external_torque = sensed};
  if (four_channel_) {
    const FourChannel::Output both = four_channel_->step(reading, leader);
    output.command.torque += both.torque;
    output.message.external_torque = both.external;
  } else if (observes_) {
    output.message.external_torque = std::visit([&](auto& one) { return one.step(reading); }, observer_) + lacking;
    if (bias_.follows()) {
      const ToolJacobian tool = chain_.jacobian(reading.position, chain_.joints() - 1, tool_m_).topRows<3>();
      output.message.external_torque -= bias_.step(output.message.external_torque, (tool * reading.velocity).norm());
    }
  }
  if (wanted_motion_.adds()) {
    output.command.torque += wanted_motion_.step(reading, leader.velocity, output.message.external_torque);
  }
  if (observes_ && !four_channel_) leave_out_dead_band(output.message.external_torque);
  saturate(output.command.torque, most_);
  if (tool_coupling_) output.message = tool_coupling_->told(reading, output.message.external_torque);
  told_.head(output.message.external_torque.size()) = output.message.external_torque;
  output.message.energy_J = passivity_.in_J();
  return output;
}

}  // namespace tactus::arm_control
