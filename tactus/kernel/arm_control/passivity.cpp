// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/passivity.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactus::arm_control {
namespace {

PassivePort at_gain(double force_gain, PassivePort port) { return force_gain > 0.0 ? port : PassivePort::none; }

std::size_t ports_of(PassivePort port, int joints) {
  if (port == PassivePort::none) return 0;
  return port == PassivePort::tool ? 1 : static_cast<std::size_t>(joints);
}

/// What torques do along a step of the joints at one port.
double work_J(PassivePort port, Eigen::Index at, const JointVector& torque, const JointVector& step) noexcept {
  return port == PassivePort::tool ? torque.dot(step) : torque[at] * step[at];
}

}  // namespace

PassiveLeader::PassiveLeader(const PassivityParams& params, double force_gain, int joints, Seconds dt)
    : port_(at_gain(force_gain, params.port)),
      joint_limits_(params.joint_limits.of(joints, &PassivityLimit::damping_N_m_s_per_rad)),
      tool_limit_N_s_per_m_(params.tool_limit_N_s_per_m),
      energy_scale_(counts() ? 1.0 / force_gain : 0.0),
      dt_s_(dt.value),
      before_(JointVector::Zero(joints)),
      acting_{before_, before_},
      sent_(acting_),
      ports_(ports_of(port_, joints)),
      in_J_(before_) {}

JointVector PassiveLeader::joint_brake(Eigen::Index joint, double lack_J, const JointVector& velocity,
                                       const JointVector& displayed) const noexcept {
  JointVector brake = JointVector::Zero(velocity.size());
  const double speed = velocity[joint];
  if (speed == 0.0) return brake;
  const double driving = displayed[joint] * speed > 0.0 ? std::fabs(displayed[joint]) : 0.0;
  const double most = std::max(joint_limits_[joint] * std::fabs(speed), driving);
  brake[joint] = std::clamp(-lack_J / (dt_s_ * speed), -most, most);
  return brake;
}

JointVector PassiveLeader::tool_brake(double lack_J, const JointVector& velocity, const JointVector& displayed,
                                      const ToolJacobian& tool) const noexcept {
  const arm::Vector3 moving_m_per_s = tool * velocity;
  const double speed_m_per_s = moving_m_per_s.norm();
  if (speed_m_per_s == 0.0) return JointVector::Zero(velocity.size());
  const double driving_N = std::max(displayed.dot(velocity), 0.0) / speed_m_per_s;
  const double most_N = std::max(tool_limit_N_s_per_m_ * speed_m_per_s, driving_N);
  const double brake_N = std::min(lack_J / (dt_s_ * speed_m_per_s), most_N);
  return tool.transpose() * (-brake_N / speed_m_per_s * moving_m_per_s);
}

JointVector PassiveLeader::brake(const ArmReading& now, const JointVector& displayed, const JointVector& other_in_J,
                                 const ToolJacobian& tool) noexcept {
  JointVector step = JointVector::Zero(now.position.size());
  if (started_) step = now.position - before_;
  started_ = true;
  before_ = now.position;
  JointVector brakes = JointVector::Zero(now.position.size());
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    control::PortObserver& port = ports_[i];
    // A torque turns the leader along its motion, so what it does is work out of the line.
    port.count(-energy_scale_ * work_J(port_, at, acting_.displayed, step));
    port.dissipate(-energy_scale_ * work_J(port_, at, acting_.applied - acting_.displayed, step));
    in_J_[at] = port.in_J();
    const double lack_J = -port.available_J(other_in_J[at]) / energy_scale_;
    if (lack_J <= 0.0) continue;
    brakes += port_ == PassivePort::tool ? tool_brake(lack_J, now.velocity, displayed, tool)
                                         : joint_brake(at, lack_J, now.velocity, displayed);
  }
  acting_ = sent_;
  sent_ = {.displayed = displayed, .applied = displayed + brakes};
  return brakes;
}

PassiveFollower::PassiveFollower(const PassivityCoupling& coupling, int joints, Seconds dt)
    : port_(at_gain(coupling.gain, coupling.params.port)),
      dt_s_(dt.value),
      recovery_per_tick_(std::min(1.0, dt.value / coupling.params.recovery_time_s)),
      before_(JointVector::Zero(joints)),
      wanted_(before_),
      ports_(ports_of(port_, joints)),
      in_J_(before_) {}

void PassiveFollower::hold_back(ArmMessage& wanted, const JointVector& told) noexcept {
  if (!started_) before_ = wanted_ = wanted.position;
  started_ = true;
  const JointVector asked = wanted.position - before_;
  JointVector step = asked + recovery_per_tick_ * (before_ - wanted_);
  before_ = wanted.position;
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    control::PortObserver& port = ports_[i];
    // What acts on the follower resists where it has the other sign than the step.
    const double done_J = -work_J(port_, at, told, step);
    port.count(-done_J);
    in_J_[at] = port.in_J();
    const double lack_J = -port.available_J(wanted.energy_J[at]);
    if (lack_J <= 0.0 || done_J <= 0.0) continue;
    const double slip_J = std::min(lack_J, done_J);
    port.dissipate(slip_J);
    if (port_ == PassivePort::tool) {
      step += slip_J / told.squaredNorm() * told;
    } else {
      step[at] += slip_J / told[at];
    }
  }
  wanted_ += step;
  wanted.position = wanted_;
  wanted.velocity += (step - asked) / dt_s_;
}

}  // namespace tactus::arm_control
