// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/supervised_site.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

/// How long a force presses after a stop, whatever the rate limit is with which forces grow.
namespace tactus::control {
namespace stop_time_test {

constexpr double tick_s = 200e-6;
constexpr Seconds tick{tick_s};
constexpr double slow_N_per_s = 0.5;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

SafetyGate::Params slow_gate(double stop_time_s = 0.25) {
  return {.force_limit_N = 5.0, .rate_limit_N_per_s = slow_N_per_s, .stop_time_s = stop_time_s};
}

/// Ticks until no force passes, in which every command is `command_N`.
template <class Gate>
int ticks_to_zero(Gate& gate, double command_N, bool stops) {
  int ticks = 0;
  while (gate.passed_N() != 0.0 && ticks < 100'000) {
    if constexpr (requires { gate.believe(0.0); }) gate.believe(0.0);
    gate.pass_or_step(command_N, stops);
    ++ticks;
  }
  return ticks;
}

struct OfForce {
  ForceGate gate;
  [[nodiscard]] double passed_N() const { return gate.passed_N(); }
  void pass_or_step(double command_N, bool stops) { gate.step(command_N, stops); }
};
struct OfSafety {
  SafetyGate gate;
  [[nodiscard]] double passed_N() const { return gate.passed_N(); }
  void believe(double position_m) { gate.believe(position_m); }
  void pass_or_step(double command_N, bool stops) { gate.pass(command_N, stops); }
};

TEST(StopTime, AForceGateFallsWithinItsStopTimeAfterAFaultAndWhileItsSiteStops) {
  for (const double stop_time_s : {0.25, 0.05}) {
    for (const double sign : {1.0, -1.0}) {
      for (const bool faults : {true, false}) {
        OfForce of{ForceGate::make({.force_limit_N = 5.0, .rate_limit_N_per_s = 50.0, .stop_time_s = stop_time_s}, tick)
                       .value()};
        for (int i = 0; i < 1000; ++i) of.gate.step(sign * 5.0);
        ASSERT_EQ(of.gate.passed_N(), sign * 5.0);
        const int ticks = ticks_to_zero(of, faults ? not_a_number : 0.0, !faults);
        // The rate limit of 50 N/s takes 0.1 s: the faster of the two counts.
        EXPECT_LE(ticks * tick_s, std::min(stop_time_s, 0.1) + 2.0 * tick_s);
      }
    }
  }
}

TEST(StopTime, ARateLimitOfHalfANewtonASecondDoesNotKeepASafetyGatePressing) {
  OfSafety grown{SafetyGate::make(slow_gate(), tick).value()};
  for (int i = 0; i < 20'000; ++i) grown.gate.step({.command_N = 3.0, .position_m = 0.0});
  ASSERT_NEAR(grown.gate.passed_N(), 2.0, 1e-6) << "it grows at the rate limit";
  OfSafety fault = grown, released = grown, stopped = grown, unstopped = grown;
  EXPECT_LE(ticks_to_zero(fault, not_a_number, false) * tick_s, 0.25);
  released.gate.release();
  EXPECT_LE(ticks_to_zero(released, 3.0, false) * tick_s, 0.25);
  EXPECT_LE(ticks_to_zero(stopped, 0.0, true) * tick_s, 0.25);
  EXPECT_NEAR(ticks_to_zero(unstopped, 0.0, false) * tick_s, 4.0, 0.01) << "a command that falls is no stop";
}

TEST(StopTime, WhileItStopsAForceNeverGrowsFasterThanTheRateLimitAndNeverPassesZeroInOneTick) {
  ForceGate gate = ForceGate::make({.force_limit_N = 5.0, .rate_limit_N_per_s = 50.0}, tick).value();
  for (int i = 0; i < 1000; ++i) gate.step(0.015, true);
  EXPECT_EQ(gate.passed_N(), 0.015);
  // 20 N/s toward zero, 50 N/s to grow: what is beyond zero has grown.
  EXPECT_GE(gate.step(-5.0, true), 0.015 - 50.0 * tick_s - 1e-12);
  ForceGate slow = ForceGate::make({.force_limit_N = 5.0, .rate_limit_N_per_s = 0.5}, tick).value();
  for (int i = 0; i < 10; ++i) slow.step(5.0);
  EXPECT_EQ(slow.step(-5.0, true), 0.0) << "1 mN falls in one tick, and no farther";
  EXPECT_NEAR(slow.step(-5.0, true), -0.5 * tick_s, 1e-15);
}

TEST(StopTime, ALateLoopFallsByTheTimeThatPassed) {
  for (const std::int64_t elapsed : {1, 3, 25}) {
    SafetyGate gate = SafetyGate::make(slow_gate(), tick).value();
    for (int i = 0; i < 20'000; ++i) gate.step({.command_N = 3.0, .position_m = 0.0});
    gate.release();
    double time_s = 0.0;
    for (; gate.passed_N() != 0.0 && time_s < 10.0; time_s += tick_s * static_cast<double>(elapsed)) {
      gate.believe(0.0, elapsed);
      gate.pass(3.0);
    }
    EXPECT_LE(time_s, 0.25 + tick_s * static_cast<double>(elapsed)) << elapsed;
  }
}

TEST(StopTime, CannotBeConfiguredLonger) {
  for (const double time_s : {0.26, 1e9, 0.0, -1.0, not_a_number}) {
    const auto made = SafetyGate::make(slow_gate(time_s), tick);
    ASSERT_FALSE(made) << time_s;
    EXPECT_EQ(made.error().parameter, "stop_time_s");
  }
}

ControlParams slow_control() {
  ControlParams control;
  control.architecture = "position-position";
  control.cancellation = CancellationMode::off;
  control.force_limit_N = 4.0;
  control.gate = control.slave_gate = slow_gate();
  control.supervision.hold.release_s = 0.2;
  control.supervision.answer_within_s = 5.0;
  return control;
}

/// Two sites whose devices are held 20 mm apart, of one axis or of several joints, and the buttons.
template <class Master, class Slave>
struct Pair {
  Master master;
  Slave slave;
  typename Master::Sensors at_handle{};
  typename Slave::Sensors at_tool{};
  SiteRequests pressed{};
  bool cut = false;
  typename Master::Output master_out{};
  typename Slave::Output slave_out{};

  void step() {
    master_out = master.step({.sensors = at_handle, .requests = pressed});
    if (!cut) slave.take(master_out.packet);
    slave_out = slave.step({.sensors = at_tool, .requests = pressed});
    if (!cut) master.take(slave_out.packet);
  }
  void steps(double duration_s) {
    for (double time_s = 0.0; time_s < duration_s; time_s += tick_s) step();
  }
  void start() {
    steps(0.01);
    pressed.align = true;
    steps(0.01);
    pressed = {.arm = true};
    steps(0.01);
    pressed = {.dead_man = true};
    steps(0.2);
    for_each_joint([](auto& joint) { joint.motor_position_m += 0.02; }, at_handle);
    steps(4.0);
  }
  [[nodiscard]] double most_N() const {
    double most_N = 0.0;
    for_each_joint([&most_N](const auto& joint) { most_N = std::max(most_N, std::fabs(joint.motor_force_N)); },
                   master_out.site);
    for_each_joint([&most_N](const auto& joint) { most_N = std::max(most_N, std::fabs(joint.motor_force_N)); },
                   slave_out.site);
    return most_N;
  }
};

Pair<SupervisedMaster, SupervisedSlave> axis() {
  return {.master = make_supervised_master(slow_control(), 11, tick).value(),
          .slave = make_supervised_slave(slow_control(), 21, tick).value()};
}
Pair<JointSupervisedMaster, JointSupervisedSlave> joints() {
  const Joints<ControlParams> control(3, slow_control());
  return {.master = make_supervised_master(control, 11, tick, Agreement{}).value(),
          .slave = make_supervised_slave(control, 21, tick, Agreement{}).value(),
          .at_handle = Joints<MasterInput>(3),
          .at_tool = Joints<SlaveInput>(3)};
}

/// Every way in which a person or a fault stops a pair.
enum class Stop { emergency, dead_man, cut, not_finite };

template <class Made>
void expect_all_stop(Made make) {
  for (const Stop stop : {Stop::emergency, Stop::dead_man, Stop::cut, Stop::not_finite}) {
    auto pair = make();
    pair.start();
    ASSERT_EQ(pair.slave.state(), SiteState::active);
    ASSERT_GT(pair.most_N(), 1.0) << static_cast<int>(stop);
    if (stop == Stop::emergency) pair.pressed = {.emergency_stop = true};
    if (stop == Stop::dead_man) pair.pressed = {};
    if (stop == Stop::cut) pair.cut = true;
    if (stop == Stop::not_finite) {
      for_each_joint([](auto& joint) { joint.motor_position_m = not_a_number; }, pair.at_handle);
      for_each_joint([](auto& joint) { joint.motor_position_m = not_a_number; }, pair.at_tool);
    }
    // A hold is noticed within the watchdog's time and fades for `release_s`; the slave stands on the dead man.
    pair.steps(0.05 + 0.2 + 0.25);
    double most_N = 0.0;
    for_each_joint([&most_N](const auto& joint) { most_N = std::max(most_N, std::fabs(joint.motor_force_N)); },
                   pair.master_out.site);
    EXPECT_EQ(most_N, 0.0) << static_cast<int>(stop);
    if (stop == Stop::dead_man) continue;
    EXPECT_EQ(pair.most_N(), 0.0) << static_cast<int>(stop);
  }
}

TEST(StopTime, WhateverStopsASiteOfOneAxisItsForceIsGoneWithinTheStatedTime) { expect_all_stop(axis); }
TEST(StopTime, WhateverStopsASiteOfSeveralJointsTheirForcesAreGoneWithinTheStatedTime) { expect_all_stop(joints); }

}  // namespace stop_time_test
}  // namespace tactus::control
