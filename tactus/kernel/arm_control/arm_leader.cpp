// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/arm_leader.hpp>
#include <tactus/kernel/arm_control/effort_limits.hpp>
#include <tactus/kernel/arm_control/joint_cutoff.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace tactus::arm_control {
namespace {

JointVector drive_damping(const ArmLeader::Params& params, int joints) {
  return params.drive_damping.of(joints, &DriveDamping::damping_N_m_s_per_rad);
}

/// Errors name the key at fault, which begins with `name`.
Result<JointLowPass> low_pass(const std::string& name, double cutoff_Hz, const EachJoint<JointCutoff>& each, int joints,
                              Seconds dt) {
  if (Check wrong = check_cutoffs(name + "_Hz", cutoff_Hz, name + "_each", each, joints, dt)) return *std::move(wrong);
  return JointLowPass::make(cutoffs(cutoff_Hz, each, joints), dt);
}

/// Of a spring that moves each joint against its Coulomb friction in a tare: that takes a quarter of the amplitude.
JointVector stiffness_over_friction(const arm::Chain::Params& arm, double amplitude_rad) {
  constexpr double over_friction = 4.0;
  JointVector stiffness(static_cast<Eigen::Index>(arm.joints.size()));
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
    stiffness[i] = over_friction * arm.joints[static_cast<std::size_t>(i)].friction.coulomb_N_m / amplitude_rad;
  }
  return stiffness;
}

/// Whether the drives pull the leader to where the follower is.
bool pulls(ArmMethod method) { return method == ArmMethod::position_position || method == ArmMethod::four_channel; }

}  // namespace

ArmLeader::ArmLeader(const Params& params, const Arm& arm, const FeedForward& feed_forward, const arm::Chain& chain,
                     const InducedMotion& model, const JointLowPass& force, const JointLowPass& command,
                     const SiteTare& tare, Seconds dt)
    : params_(params),
      feed_forward_(feed_forward),
      chain_(chain),
      tool_m_(arm.induced.tool_m),
      stiffness_(JointVector::Zero(chain.joints())),
      damping_(pulls(params.method) ? stiffness_ : drive_damping(params, chain.joints())),
      damping_limit_(damping_, params.drive_damping_limit_N_s_per_m),
      washed_damping_(pulls(params.method) ? 0.0 : params.damping_washout_Hz, effort_limits(arm.carried), dt),
      tare_(tare),
      over_friction_(stiffness_over_friction(arm.carried, arm.tare.amplitude_rad)),
      dt_s_(dt.value),
      model_(model),
      factr_(params.factr, arm.carried, chain),
      avoidance_(params.avoidance, chain.joints()),
      four_channel_(params.four_channel, FourChannel::Side::leader, params.force_gain, arm.carried, chain, dt),
      passivity_(params.passivity, params.force_gain, chain.joints(), dt),
      force_(force),
      command_position_(command),
      command_velocity_(command),
      most_(effort_limits(arm.carried)),
      undisplayed_(stiffness_),
      acting_(stiffness_) {
  if (params.method == ArmMethod::four_channel) {
    stiffness_ = four_channel_.stiffness();
    damping_ = four_channel_.damping();
  }
  if (params.method != ArmMethod::position_position) return;
  for (std::size_t i = 0; i < arm.gains.size(); ++i) {
    stiffness_[static_cast<Eigen::Index>(i)] = params.force_gain * arm.gains[i].stiffness_N_m_per_rad;
    damping_[static_cast<Eigen::Index>(i)] = params.force_gain * arm.gains[i].damping_N_m_s_per_rad;
  }
}

Result<ArmLeader> ArmLeader::make(const Params& params, const Arm& arm, Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  if (params.passivity.port != PassivePort::none && pulls(params.method)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "passivity.port",
                 .message = std::string(name_of(params.method)) +
                            " reflects no torque whose energy could be counted: write none, or another method",
                 .place = {}};
  }
  const auto chain = arm::Chain::make(arm.carried);
  if (!chain) return chain.error();
  const InducedMotion::Site site{.damping_N_s_per_m = params.damping_N_s_per_m,
                                 .drive_damping_N_m_s_per_rad = drive_damping(params, chain->joints()),
                                 .drive_damping_limit_N_s_per_m = params.drive_damping_limit_N_s_per_m,
                                 .friction_share = params.feed_forward.friction_share,
                                 .friction_velocity_rad_per_s = params.feed_forward.friction_velocity_rad_per_s,
                                 .damping_washout_Hz = params.damping_washout_Hz};
  const auto model = InducedMotion::make(params.model, site, arm.induced, dt);
  if (!model) return under("model", model.error());
  const int joints = chain->joints();
  const auto force = low_pass("force_low_pass", params.force_low_pass_Hz, params.force_low_pass_each, joints, dt);
  if (!force) return force.error();
  const auto command =
      low_pass("command_low_pass", params.command_low_pass_Hz, params.command_low_pass_each, joints, dt);
  if (!command) return command.error();
  const auto tare =
      SiteTare::make(arm.tare, arm.carried, *chain, {JointVector::Zero(joints), JointVector::Zero(joints)},
                     arm.lacking_N_m.size() == joints ? arm.lacking_N_m : JointVector::Zero(joints), dt);
  if (!tare) return under("tare", tare.error());
  return ArmLeader(params, arm, FeedForward(params.feed_forward, arm.carried, *chain), *chain, *model, *force, *command,
                   *tare, dt);
}

std::optional<double> ArmLeader::force_gain() const noexcept {
  if (pulls(params_.method) || passivity_.counts()) return std::nullopt;
  return params_.force_gain;
}

/// What moves the leader in a tare over the bus, in this pose: firm, and with dampers that two cycles of delay bear.
Tare::Drives ArmLeader::tare_drives(const JointVector& position) const noexcept {
  constexpr double firm_rad_per_s = 20.0, damping_ratio = 0.7, share_a_tick = 0.3;
  const JointVector inertia = chain_.mass_matrix(position).diagonal();
  const JointVector stiffness = over_friction_ + firm_rad_per_s * firm_rad_per_s * inertia;
  return {
      .stiffness_N_m_per_rad = stiffness,
      .damping_N_m_s_per_rad =
          (2.0 * damping_ratio * stiffness.cwiseProduct(inertia).cwiseSqrt()).cwiseMin(share_a_tick / dt_s_ * inertia)};
}

ToolJacobian ArmLeader::tool_at(const JointVector& position) const noexcept {
  return chain_.jacobian(position, chain_.joints() - 1, tool_m_).topRows<3>();
}

/// All of the bus's torque but what comes from the follower.
JointVector ArmLeader::beside_display(const ArmReading& reading, const JointVector& support,
                                      const JointVector& external) noexcept {
  JointVector torque = support;
  const bool gives_back = !pulls(params_.method) && damping_limit_.limits();
  if (params_.damping_N_s_per_m > 0.0 || gives_back || washed_damping_.washes()) {
    const ToolJacobian tool = tool_at(reading.position);
    const arm::Vector3 velocity = tool * reading.velocity;
    arm::Vector3 force_N = -params_.damping_N_s_per_m * velocity;
    const arm::Matrix3 excess = gives_back ? damping_limit_.excess(tool) : arm::Matrix3(arm::Matrix3::Zero());
    if (gives_back) force_N += excess * velocity;
    torque += tool.transpose() * force_N;
    if (washed_damping_.washes()) {
      const arm::Matrix3 over_the_bus = params_.damping_N_s_per_m * arm::Matrix3::Identity() - excess;
      JointMatrix dampers = tool.transpose() * over_the_bus * tool;
      dampers.diagonal() += damping_;
      torque += washed_damping_.step(tool, dampers, reading.velocity, external);
    }
  }
  if (params_.method == ArmMethod::factr) torque += factr_.step(reading);
  return torque;
}

ArmLeader::Output ArmLeader::step(const ArmReading& reading, const ArmMessage& follower) noexcept {
  const int joints = chain_.joints();
  if (!started_) {
    command_position_.settle(reading.position);
    started_ = true;
  }
  const bool reflects = !pulls(params_.method);
  Output output;
  output.support = feed_forward_.torque(reading);
  if (tare_.starts()) tare_.use(tare_drives(reading.position));
  if (tare_.acts()) {
    const ArmCommand moves = tare_.step(reading);
    output.support.array() += moves.stiffness.array() * (moves.position - reading.position).array() -
                              moves.damping.array() * reading.velocity.array();
  }
  output.support += tare_.lacking_N_m();
  const JointVector undisplayed = beside_display(reading, output.support, follower.external_torque);
  JointVector displayed = JointVector::Zero(joints);
  if (reflects) displayed = params_.force_gain * force_.step(follower.external_torque);
  if (params_.method == ArmMethod::feedback_avoidance) {
    displayed = avoidance_.displayed(displayed, reading.velocity);
  }
  if (passivity_.counts())
    displayed += passivity_.brake(reading, displayed, follower.energy_J, tool_at(reading.position));
  JointVector own_external = JointVector::Zero(joints);
  if (params_.method == ArmMethod::four_channel) {
    const FourChannel::Output both = four_channel_.step(reading, follower);
    displayed = both.torque;
    own_external = both.external;
  }

  output.command = ArmCommand::of_torque(undisplayed + displayed);
  saturate(output.command.torque, most_);
  undisplayed_ = undisplayed;
  output.command.damping = damping_;
  if (!reflects) {
    output.command.position = follower.position;
    output.command.velocity = follower.velocity;
    output.command.stiffness = stiffness_;
  }
  if (params_.method != ArmMethod::position_position) displayed = output.command.torque - undisplayed;
  output.displayed = displayed;
  output.induced = JointVector::Zero(joints);
  output.message = {.position = reading.position,
                    .velocity = reading.velocity,
                    .external_torque = own_external,
                    .energy_J = passivity_.in_J()};
  if (params_.method == ArmMethod::cancellation) {
    output.induced = model_.position();
    output.message.position -= output.induced;
    output.message.velocity -= model_.velocity();
    model_.step(acting_, reading.position, reading.velocity,
                washed_damping_.washes() ? washed_damping_.left() : JointMatrix());
    acting_ = displayed;
  }
  output.message.position = command_position_.step(output.message.position);
  output.message.velocity = command_velocity_.step(output.message.velocity);
  return output;
}

void ArmLeader::applied(const JointVector& torque) noexcept {
  if (params_.method == ArmMethod::cancellation) acting_ = torque - undisplayed_;
  if (passivity_.counts()) passivity_.applied(torque - undisplayed_);
}

}  // namespace tactus::arm_control
