#include <tactus/arm_control/arm_follower.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>

namespace tactus::arm_control {

ArmFollower::ArmFollower(const Params& params, const FeedForward& feed_forward, const Observer& observer,
                         const Joints<control::ForceGate>& gates)
    : feed_forward_(feed_forward),
      observer_(observer),
      gates_(gates),
      observes_(params.torque == TorqueSource::observer),
      stiffness_(JointVector::Zero(static_cast<Eigen::Index>(gates.size()))),
      damping_(stiffness_) {
  const Joints<DriveGains> gains = params.gains.of(gates.size());
  for (std::size_t i = 0; i < gains.size(); ++i) {
    stiffness_[static_cast<Eigen::Index>(i)] = params.stiffness_share * gains[i].stiffness_N_m_per_rad;
    damping_[static_cast<Eigen::Index>(i)] = gains[i].damping_N_m_s_per_rad;
  }
}

Result<ArmFollower::Observer> ArmFollower::make_observer(const TorqueObserverParams& params,
                                                         const arm::Chain::Params& arm, const arm::Chain& chain,
                                                         const JointVector& joint_stiffness, Seconds dt) {
  if (params.joints == JointModel::rigid) {
    const auto rigid = ExternalTorqueObserver::make(params, chain, dt);
    if (!rigid) return rigid.error();
    return Observer(*rigid);
  }
  const auto elastic = ElasticTorqueObserver::make(params, arm, joint_stiffness, dt);
  if (!elastic) return elastic.error();
  return Observer(*elastic);
}

Result<ArmFollower> ArmFollower::make(const Params& params, const arm::Chain::Params& arm, Seconds dt,
                                      const JointVector& joint_stiffness) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  const auto chain = arm::Chain::make(arm);
  if (!chain) return chain.error();
  const auto observer = make_observer(params.observer, arm, *chain, joint_stiffness, dt);
  if (!observer) return under("observer", observer.error());
  Joints<control::ForceGate::Params> limits(arm.joints.size());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    limits[i].force_limit_N = std::min(100.0, arm.joints[i].limits.effort_N_m);
  }
  const auto gates = make_each<control::ForceGate>(limits, dt);
  if (!gates) return gates.error();
  return ArmFollower(params, FeedForward(params.feed_forward, arm, *chain), *observer, *gates);
}

ArmFollower::Output ArmFollower::step(const ArmReading& reading, const JointVector& sensed,
                                      const ArmMessage& leader) noexcept {
  Output output;
  output.command = {.position = leader.position,
                    .velocity = leader.velocity,
                    .stiffness = stiffness_,
                    .damping = damping_,
                    .torque = feed_forward_.torque(reading)};
  for (std::size_t i = 0; i < gates_.size(); ++i) {
    double& torque = output.command.torque[static_cast<Eigen::Index>(i)];
    torque = gates_[i].step(torque);
  }
  output.message = {
      .position = reading.position,
      .velocity = reading.velocity,
      .external_torque = observes_ ? std::visit([&](auto& one) { return one.step(reading); }, observer_) : sensed};
  return output;
}

}  // namespace tactus::arm_control
