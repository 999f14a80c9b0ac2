// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <tests/sweeps/simulated_side.hpp>

namespace tactus::sweeps {

namespace {

constexpr double longest_step_s = 5e-4, arm_step_s = 2e-4;
/// Metres that a radian of a lever is, of a joint that slides.
constexpr double lever_m = 0.2;
constexpr double hand_rad_per_s = 2.0 * std::numbers::pi * 4.0, hand_damping_ratio = 0.7;

}  // namespace

SimulatedSide::SimulatedSide(const devices::RigSide& side, const station::DescribedArm* arm, bool is_led,
                             bool meets_stops, const signal::Random& random)
    : is_led_(is_led), random_(random) {
  constexpr double turn = 2.0 * std::numbers::pi, servo_step_rad = turn / 4096.0, damiao_step_rad = 25.0 / 65535.0;
  switch (side.bus.kind) {
    case devices::BusKind::dynamixel:
      cycle_s_ = filter_s_ = 0.004;
      position_step_ = servo_step_rad;
      break;
    case devices::BusKind::feetech:
      cycle_s_ = 0.008;
      filter_s_ = 0.005;
      position_step_ = servo_step_rad;
      break;
    case devices::BusKind::inverse3:
      position_step_ = 1e-5;
      break;
    default:
      position_step_ = damiao_step_rad;
  }
  of_arm_ = arm != nullptr ? arm->joints.size() : 0;
  arm::JointVector inertia;
  if (arm != nullptr) {
    arm::PhysicalArm is = arm->arm;
    is.step_s = arm_step_s;
    began_at_ = arm->start;
    inertia = arm::Chain::make(is.chain)->mass_matrix(arm->start).diagonal();
    arm_.emplace(*arm_plants::ArmPlant::make(is, arm->start));
  }
  for (std::size_t i = 0; i < side.joints.size(); ++i) {
    Joint joint;
    joint.is = side.joints[i].joint;
    const bool slides = joint.slides = side.joints[i].slides;
    const double unit = slides ? lever_m : 1.0;
    const bool weighs = i < of_arm_;
    joint.inertia = weighs ? inertia[static_cast<Eigen::Index>(i)]
                           : (slides ? random_.uniform(0.2, 0.4) : random_.uniform(0.01, 0.03));
    joint.friction = slides ? random_.uniform(0.1, 0.3) : random_.uniform(0.01, 0.04);
    const double half_range = 0.5 * (joint.is.upper_rad - joint.is.lower_rad);
    joint.reach = weighs ? 0.3 : std::min(random_.uniform(0.4, 0.8) * half_range, 0.8 * unit);
    const double fastest = weighs ? random_.uniform(0.5, 1.0) : unit * random_.uniform(0.8, 2.0);
    joint.rad_per_s = fastest / joint.reach;
    if (meets_stops && !is_led) joint.stop = 0.5 * joint.reach;
    if (weighs) joint.position = began_at_[static_cast<Eigen::Index>(i)];
    joints_.push_back(joint);
  }
  stands_ = arm != nullptr;
}

void SimulatedSide::is_supported_by(double share, bool has_weight) noexcept {
  stands_ = has_weight && stands_ && share < 1.0;
}

double SimulatedSide::from_outside(const Joint& joint, double position, double velocity) const noexcept {
  const auto at = static_cast<std::size_t>(&joint - joints_.data());
  const double home = at < of_arm_ ? began_at_[static_cast<Eigen::Index>(at)] : 0.0;
  double force = 0.0;
  // An arm is let alone until its motors were tried: a hand that holds it like a spring takes it back between the lobes
  // of a trial, which looks as if it had moved the wrong way.
  if (is_led_ && (moves_ || at >= of_arm_)) {
    const double phase = joint.rad_per_s * path_s_;
    const double wanted = home + joint.reach * std::sin(phase);
    const double wanted_per_s = moves_ ? joint.reach * joint.rad_per_s * std::cos(phase) : 0.0;
    force = joint.inertia * (hand_rad_per_s * hand_rad_per_s * (wanted - position) +
                             2.0 * hand_damping_ratio * hand_rad_per_s * (wanted_per_s - velocity));
  }
  const double beyond = position - home - joint.stop;
  if (beyond > 0.0) {
    constexpr double swings = 2.0 * std::numbers::pi * 15.0;
    force -= std::max(0.0, joint.inertia * (swings * swings * beyond + 0.5 * swings * velocity));
  }
  return force;
}

void SimulatedSide::step_joints(double step_s) {
  for (std::size_t i = of_arm_; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const double gear = static_cast<double>(joint.is.sign) * joint.is.gear;
    joint.torque = 0.0;
    if (joint.acts.enabled != 0) {
      const double motor = gear * (joint.position - joint.is.offset_rad), motor_per_s = gear * joint.velocity;
      const devices::MotorLaw& law = joint.acts.law;
      joint.torque = gear * (joint.acts.torque_Nm + law.stiffness_Nm_per_rad * (law.position_rad - motor) +
                             law.damping_Nms_per_rad * (law.velocity_rad_per_s - motor_per_s));
    }
    const double force = joint.torque + from_outside(joint, joint.position, joint.velocity);
    const double free = joint.velocity + step_s * force / joint.inertia,
                 slows = step_s * joint.friction / joint.inertia;
    joint.velocity = std::fabs(free) <= slows ? 0.0 : free - std::copysign(slows, free);
    joint.position += step_s * joint.velocity;
  }
}

void SimulatedSide::advance(std::int64_t now_ns, double tick_s) {
  if (moves_) path_s_ += tick_s;
  const auto steps = static_cast<int>(std::ceil(tick_s / longest_step_s - 1e-9));
  for (int i = 0; i < steps; ++i) step_joints(tick_s / steps);
  if (arm_ && stands_) {
    // Something bears it and it does not move, whatever its motors give.
    for (std::size_t i = 0; i < of_arm_; ++i) {
      Joint& joint = joints_[i];
      const devices::MotorLaw& law = joint.acts.law;
      const double gear = static_cast<double>(joint.is.sign) * joint.is.gear;
      const double motor = gear * (joint.position - joint.is.offset_rad);
      joint.torque = joint.acts.enabled == 0
                         ? 0.0
                         : gear * (joint.acts.torque_Nm + law.stiffness_Nm_per_rad * (law.position_rad - motor) +
                                   law.damping_Nms_per_rad * law.velocity_rad_per_s);
    }
  } else if (arm_) {
    arm::ArmCommand command = arm::ArmCommand::of_torque(arm::JointVector::Zero(began_at_.size()));
    for (int step = 0; step < std::lround(tick_s / arm_step_s); ++step) {
      const arm::JointVector position = arm_->link_position(), velocity = arm_->link_velocity();
      for (std::size_t i = 0; i < of_arm_; ++i) {
        const Joint& joint = joints_[i];
        const auto at = static_cast<Eigen::Index>(i);
        const double gear = static_cast<double>(joint.is.sign) * joint.is.gear;
        const bool on = joint.acts.enabled != 0;
        command.position[at] = joint.is.position_rad(joint.acts.law.position_rad);
        command.velocity[at] = joint.is.velocity_rad_per_s(joint.acts.law.velocity_rad_per_s);
        command.stiffness[at] = on ? gear * gear * joint.acts.law.stiffness_Nm_per_rad : 0.0;
        command.damping[at] = on ? gear * gear * joint.acts.law.damping_Nms_per_rad : 0.0;
        command.torque[at] = (on ? gear * joint.acts.torque_Nm : 0.0) + from_outside(joint, position[at], velocity[at]);
      }
      arm_->write(command);
      arm_->step({});
    }
    const arm::JointVector position = arm_->link_position(), velocity = arm_->link_velocity();
    for (std::size_t i = 0; i < of_arm_; ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      Joint& joint = joints_[i];
      joint.position = position[at];
      joint.velocity = velocity[at];
      joint.torque = 0.0;
      if (joint.acts.enabled == 0) continue;
      joint.torque = command.torque[at] - from_outside(joint, position[at], velocity[at]) +
                     command.stiffness[at] * (command.position[at] - position[at]) +
                     command.damping[at] * (command.velocity[at] - velocity[at]);
    }
  }
  for (Joint& joint : joints_) {
    joint.reported_velocity += (1.0 - std::exp(-tick_s / filter_s_)) * (joint.velocity - joint.reported_velocity);
  }
  if (fault_ != PositionFault::none) {
    const Joint& joint = joints_[spoiled_];
    const double travelled = std::fabs(joint.position - spoiled_at_);
    travelled_rad_ = std::max(travelled_rad_, joint.slides ? travelled / lever_m : travelled);
  }
  if (now_ns < next_cycle_ns_) return;
  measure(now_ns);
  for (std::size_t i = 0; i < joints_.size(); ++i) joints_[i].acts = commanded_.motors[i];
  constexpr double late_share = 0.003, latest_s = 0.015;
  const double cycle_s = cycle_s_ + (random_.uniform() < late_share ? random_.uniform(0.0, latest_s) : 0.0);
  next_cycle_ns_ = now_ns + static_cast<std::int64_t>(1e9 * (cycle_s - 0.5 * tick_s));
}

double SimulatedSide::counted(const Joint& joint, double position, bool noisy) {
  const double gear = static_cast<double>(joint.is.sign) * joint.is.gear;
  double count = std::round(gear * (position - joint.is.offset_rad) / position_step_);
  if (noisy && random_.uniform() < 0.2) count += random_.uniform() < 0.5 ? 1.0 : -1.0;
  return position_step_ * count;
}

double SimulatedSide::wrong_position(const Joint& joint) {
  const double moved = joint.position - spoiled_at_;
  switch (fault_) {
    case PositionFault::frozen:
      if (!frozen_rad_) frozen_rad_ = counted(joint, spoiled_at_, false);
      return *frozen_rad_;
    case PositionFault::stuck:
      return counted(joint, spoiled_at_, true);
    case PositionFault::scaled_down:
    case PositionFault::scaled_up:
      return counted(joint, spoiled_at_ + scale_ * moved, true);
    case PositionFault::reversed:
      return counted(joint, spoiled_at_ - moved, true);
    case PositionFault::late: {
      history_.push_back(joint.position);
      const auto lag = static_cast<std::size_t>(late_s_ / cycle_s_);
      return counted(joint, history_[history_.size() - 1 - std::min(lag, history_.size() - 1)], true);
    }
    default:
      return counted(joint, joint.position, true);
  }
}

void SimulatedSide::measure(std::int64_t now_ns) {
  constexpr double torque_share = 0.005, velocity_noise = 0.02;
  devices::BusReadings read = newest_.value_or(devices::BusReadings{});
  read.state = devices::BusState::ready;
  ++read.cycles;
  read.time_ns = now_ns - static_cast<std::int64_t>(1e9 * random_.uniform(1e-4, 2e-4));
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const double gear = static_cast<double>(joint.is.sign) * joint.is.gear;
    const bool is_wrong = fault_ != PositionFault::none && i == spoiled_;
    const double step = joint.is.velocity_step_rad_per_s;
    const double noise = joint.slides ? lever_m * velocity_noise : velocity_noise;
    double velocity = gear * (joint.reported_velocity + noise * random_.normal());
    if (is_wrong && fault_ == PositionFault::wrong_velocity) velocity = -velocity;
    const double torque_step = torque_share * std::max(joint.is.torque_limit_Nm, 1e-3);
    devices::MotorReading& motor = read.motors[i];
    motor.position_rad = is_wrong ? wrong_position(joint) : counted(joint, joint.position, true);
    motor.velocity_rad_per_s = step > 0.0 ? step * std::trunc(velocity / step) : velocity;
    motor.torque_Nm = torque_step * std::round(joint.torque / torque_step + 0.5 * random_.normal()) *
                      static_cast<double>(joint.is.sign) / joint.is.gear;
    motor.temperature_C = 30.0;
    motor.enabled = joint.acts.enabled;
    motor.off = joint.acts.enabled == 0 ? 1 : 0;
    motor.status = 0;
    motor.received_ns = read.time_ns - static_cast<std::int64_t>(1e9 * random_.uniform(1e-4, 6e-4));
    motor.answers = ++joint.answers;
  }
  newest_ = read;
}

void SimulatedSide::spoil(std::size_t joint, PositionFault fault) noexcept {
  fault_ = fault;
  spoiled_ = joint;
  spoiled_at_ = joints_[joint].position;
  scale_ = fault == PositionFault::scaled_down ? random_.uniform(0.0, 0.5) : random_.uniform(1.5, 3.0);
  late_s_ = random_.uniform(0.15, 0.4);
}

}  // namespace tactus::sweeps
