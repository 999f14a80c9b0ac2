// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/simulation/experiments/arm_faults/plan.hpp>
#include <tactus/simulation/experiments/faults/faulty_operator.hpp>
#include <tactus/simulation/teleoperator/bad_number.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>
#include <tactus/simulation/teleoperator/faulty_actuator.hpp>
#include <tactus/simulation/teleoperator/faulty_clock.hpp>
#include <tactus/simulation/teleoperator/faulty_encoder.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactus::experiments {

/// Everything that one plan does to a run of two arms: the parts of `FaultInjection`, each at one joint of one arm.
class ArmFaultInjection {
 public:
  struct Site {
    simulation::FaultyClock clock;
    simulation::FaultyEncoder encoder;
    simulation::FaultyActuator actuator;
    Site(const FaultPlan& plan, FaultSite site, double tick_s)
        : clock(plan, site), encoder(plan, site, tick_s), actuator(plan, site, tick_s) {}
  };

  ArmFaultInjection(const FaultPlan& plan, std::size_t joints, double tick_s)
      : master(plan, FaultSite::master, tick_s),
        slave(plan, FaultSite::slave, tick_s),
        person(plan),
        plan_(plan),
        joint_(joint_of_plan(plan, joints)),
        span_(plan.start_s, plan.start_s + plan.length_s, tick_s) {}

  Site master, slave;
  FaultyOperator person;

  [[nodiscard]] Site& at(FaultSite site) noexcept { return site == FaultSite::master ? master : slave; }
  [[nodiscard]] const simulation::FaultSpan& span() const noexcept { return span_; }
  [[nodiscard]] const FaultMoment& moment() const noexcept { return moment_; }
  void enter(std::int64_t tick) noexcept { moment_ = span_.at(tick); }

  /// No packet passes either way.
  [[nodiscard]] bool cuts() const noexcept { return plan_.kind == FaultKind::cut && moment_.during; }
  /// A control: each site receives its own agreement in place of the other's.
  [[nodiscard]] bool hides_disagreement() const noexcept {
    return plan_.kind == FaultKind::configurations_differ && plan_.size == 1.0;
  }
  /// A drive of `site` has no power, and states it.
  [[nodiscard]] bool is_without_power(FaultSite site) const noexcept {
    return plan_.kind == FaultKind::power_lost && plan_.site == site && moment_.during;
  }
  /// Puts what the host receives of the drives in place of what is true. Once a tick.
  void misread(FaultSite site, Joints<station::DeviceReading>& reading) noexcept {
    station::DeviceReading& joint = reading[joint_];
    joint.position_m = at(site).encoder.step(joint.position_m, moment_);
    if (plan_.site != site) return;
    if (moment_.begins) spoil_number(joint);
    if (!moment_.during) return;
    control::DriveReport& tells = joint.motor_report;
    if (plan_.kind == FaultKind::encoder_reversed) tells.velocity_m_per_s = -tells.velocity_m_per_s;
    if (plan_.kind == FaultKind::encoder_freeze) tells.velocity_m_per_s = 0.0;
    // What a drive assumes to give, from its current.
    if (plan_.kind == FaultKind::motor_reversed) tells.force_N = -tells.force_N;
    if (plan_.kind == FaultKind::torque_constant) tells.force_N /= plan_.size;
  }
  /// Puts what the drives make of a command in its place: the drive's law is its own, and is as wrong as the motor.
  void misdrive(FaultSite site, Joints<station::DeviceCommand>& command) noexcept {
    station::DeviceCommand& joint = command[joint_];
    const double share = at(site).actuator.step(1.0, true, moment_);
    if (share == 1.0) return;
    joint.force_N *= share;
    joint.law = joint.law.times(share);
  }

  /// What `FaultProcessOf` asks, alongside the clock.
  [[nodiscard]] bool sleeps() const noexcept { return false; }
  [[nodiscard]] double age_error_s(FaultSite) const noexcept { return 0.0; }
  void spoil(FaultSite site, control::JointPacket& packet) const noexcept {
    if (plan_.kind != FaultKind::bad_number || plan_.site != site || !moment_.begins || input() < told_of_drive) return;
    const std::size_t which = input() - told_of_drive;
    if (which == numbers.size()) {
      packet.age_s = bad_value();
    } else if (joint_ < packet.message.size()) {
      packet.message[joint_].*numbers[which] = bad_value();
    }
  }

 private:
  static constexpr std::size_t told_of_drive = 3;
  static constexpr std::array numbers{&control::Message::position_m, &control::Message::velocity_m_per_s,
                                      &control::Message::force_N};
  static constexpr std::size_t inputs = told_of_drive + numbers.size() + 1;

  /// Which number it is, those of the drive first, then those of a packet and its age: each with each value in turn.
  [[nodiscard]] std::size_t input() const noexcept { return static_cast<std::size_t>(plan_.choice) % inputs; }
  [[nodiscard]] double bad_value() const noexcept {
    const auto& values = simulation::BadNumber::values;
    return values[static_cast<std::size_t>(plan_.choice) % values.size()];
  }
  void spoil_number(station::DeviceReading& joint) const noexcept {
    if (plan_.kind != FaultKind::bad_number || input() >= told_of_drive) return;
    double* const told[told_of_drive] = {&joint.position_m, &joint.motor_report.velocity_m_per_s,
                                         &joint.motor_report.force_N};
    *told[input()] = bad_value();
  }

  FaultPlan plan_;
  std::size_t joint_;
  simulation::FaultSpan span_;
  FaultMoment moment_;
};

}  // namespace tactus::experiments
