// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/position_position.hpp>

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tactus::control {
namespace position_position_test {

constexpr double tick_s = 200e-6;

PositionPositionMaster::Params plain() {
  PositionPositionMaster::Params params;
  params.position_force.cancellation = CancellationMode::off;
  return params;
}
PositionPositionMaster master(const PositionPositionMaster::Params& params) {
  return PositionPositionMaster::make(params, Seconds{tick_s}).value();
}
PositionPositionSlave slave() { return PositionPositionSlave::make({}, Seconds{tick_s}).value(); }

MasterInput at_master(double position_m, double slave_position_m) {
  return {.motor_position_m = position_m, .arrival = {.message = {.position_m = slave_position_m}, .fresh = true}};
}
SlaveInput at_slave(double position_m, double command_m) {
  return {.motor_position_m = position_m, .arrival = {.message = {.position_m = command_m}, .fresh = true}};
}

TEST(PositionPositionMaster, AnOffsetAtRestPullsWithScaledStiffnessTimesTheErrorUpToTheLimit) {
  PositionPositionMaster::Params params = plain();
  params.position_force.position_scale = 0.5;
  params.position_force.force_gain = 3.0;
  params.position_force.force_limit_N = 0.9;
  params.coupling.proportional_N_per_m = 200.0;
  for (const double master_m : {-0.02, -0.001, 0.0, 0.0005, 0.002, 0.03}) {
    PositionPositionMaster site = master(params);
    double force_N = 0.0;
    for (int tick = 0; tick < 50; ++tick) force_N = site.step(at_master(master_m, 0.0004)).motor_force_N;
    const double spring_N = -3.0 * 200.0 * (0.5 * master_m - 0.0004);
    EXPECT_NEAR(force_N, std::fmin(0.9, std::fmax(-0.9, spring_N)), 1e-12) << master_m;
  }
}

TEST(PositionPositionMaster, BeforeTheSlaveIsHeardThereIsNoForceAndThenNoKick) {
  PositionPositionMaster site = master(plain());
  MasterInput silent = at_master(-0.008, 0.0);
  silent.arrival.fresh = false;
  for (int tick = 0; tick < 10; ++tick) EXPECT_EQ(site.step(silent).motor_force_N, 0.0);
  for (int tick = 0; tick < 10; ++tick) EXPECT_EQ(site.step(at_master(-0.008, -0.008)).motor_force_N, 0.0);
}

TEST(PositionPositionMaster, ASlaveThatFallsSilentPullsFromWhereItWasLast) {
  PositionPositionMaster site = master(plain());
  for (int tick = 0; tick < 10; ++tick) site.step(at_master(0.001, 0.001));
  MasterInput silent = at_master(0.003, 0.001);
  silent.arrival.fresh = false;
  double force_N = 0.0;
  for (int tick = 0; tick < 500; ++tick) force_N = site.step(silent).motor_force_N;
  EXPECT_NEAR(force_N, -100.0 * 0.002, 1e-9);
}

TEST(PositionPositionMaster, ASteadyMotionFeelsTheRoundTripAsDrag) {
  constexpr double speed_m_per_s = 0.05;
  constexpr int round_trip_ticks = 100;
  PositionPositionMaster site = master(plain());
  double force_N = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    const double position_m = speed_m_per_s * tick_s * tick;
    force_N = site.step(at_master(position_m, position_m - speed_m_per_s * tick_s * round_trip_ticks)).motor_force_N;
  }
  EXPECT_NEAR(force_N, -100.0 * speed_m_per_s * (tick_s * round_trip_ticks), 1e-9);
}

TEST(PositionPositionSlave, TellsWhereItIsAndNotWhatItTouches) {
  SlaveInput input = at_slave(0.0123, 0.02);
  input.tip_force_N = 0.7;
  const auto out = slave().step(input);
  EXPECT_EQ(out.message.position_m, 0.0123);
  EXPECT_EQ(out.message.force_N, 0.0);
}

TEST(PositionPosition, EachDeviceIsPulledTowardTheOtherByOppositeForces) {
  PositionPositionMaster::Params params = plain();
  params.position_force.force_limit_N = 100.0;
  PositionPositionMaster at_m = master(params);
  PositionPositionSlave at_s = slave();
  for (int tick = 0; tick < 3000; ++tick) {
    const double x_m = 0.010 * std::sin(0.011 * tick), x_s = 0.007 * std::cos(0.017 * tick);
    const auto m = at_m.step(at_master(x_m, x_s));
    const auto s = at_s.step(at_slave(x_s, m.message.position_m));
    ASSERT_NEAR(m.motor_force_N, -s.motor_force_N, 1e-12);
  }
}

/// Energy that both sites take from the devices in whole periods of two sines, over the one that the relative motion
/// dissipates in a damper of 1 N s/m.
double damping_seen(double master_amplitude_m, double slave_amplitude_m, double phase) {
  constexpr int ticks_per_period = 5000;
  constexpr double omega = 2.0 * std::numbers::pi / (ticks_per_period * tick_s);
  PositionPositionMaster::Params params = plain();
  params.position_force.force_limit_N = 100.0;
  PositionPositionMaster at_m = master(params);
  PositionPositionSlave at_s = slave();
  const auto x_m = [&](int tick) { return master_amplitude_m * std::sin(omega * tick_s * tick); };
  const auto x_s = [&](int tick) { return slave_amplitude_m * std::sin(omega * tick_s * tick + phase); };
  double taken_J = 0.0;
  for (int tick = 0; tick < 2 * ticks_per_period; ++tick) {
    const auto m = at_m.step(at_master(x_m(tick), x_s(tick)));
    const auto s = at_s.step(at_slave(x_s(tick), m.message.position_m));
    if (tick < ticks_per_period) continue;  // the filters' transients
    taken_J -= m.motor_force_N * (x_m(tick + 1) - x_m(tick)) + s.motor_force_N * (x_s(tick + 1) - x_s(tick));
  }
  const double relative2_m2 = master_amplitude_m * master_amplitude_m + slave_amplitude_m * slave_amplitude_m -
                              2.0 * master_amplitude_m * slave_amplitude_m * std::cos(phase);
  return taken_J / (0.5 * omega * omega * relative2_m2 * ticks_per_period * tick_s);
}

TEST(PositionPosition, WithoutDelayAndScaleBothSitesTogetherAreADamperLessWhatSamplingTakesFromTheSpring) {
  // Held over a tick, a spring lags by half of one: k_d − k_p dt / 2 remains (Colgate and Brown).
  const double expected = 0.65 - 100.0 * tick_s / 2.0;
  EXPECT_NEAR(damping_seen(0.01, 0.0, 0.0), expected, 2e-3);
  EXPECT_NEAR(damping_seen(0.0, 0.01, 0.0), expected, 2e-3);
  EXPECT_NEAR(damping_seen(0.01, 0.006, 2.0), expected, 2e-3);
  EXPECT_NEAR(damping_seen(0.01, 0.01, -1.0), expected, 2e-3);
}

}  // namespace position_position_test
}  // namespace tactus::control
