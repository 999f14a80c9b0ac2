// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/servo_hydraulic_slave.hpp>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace servo_hydraulic_slave_test {

static_assert(Element<ServoValve>);
static_assert(Element<ServoHydraulicSlave>);
static_assert(Element<PressureSensor>);
static_assert(Element<PositionTransducer>);

constexpr double step_s = 1e-5;

/// Without dry friction, so that the motion is smooth.
ServoHydraulicSlave::Params smooth() {
  ServoHydraulicSlave::Params params;
  params.cylinder.friction.coulomb_N = 0.0;
  params.cylinder.friction.static_N = 0.0;
  return params;
}

ServoHydraulicSlave made(const ServoHydraulicSlave::Params& params, double dt_s = step_s) {
  return ServoHydraulicSlave::make(params, Seconds{dt_s}).value();
}

/// The current that the oracle plays, at the middle of a step.
double two_sines_mA(double time_s) {
  constexpr double two_pi = 2.0 * std::numbers::pi;
  return 4.0 * std::sin(two_pi * 3.0 * time_s) + std::sin(two_pi * 40.0 * time_s);
}

/// Largest difference to the oracle in position, in m, and in force, in N.
std::pair<double, double> error_against_oracle(double dt_s) {
  const OracleTable oracle("mechanics_servo_hydraulic_slave");
  const auto times = oracle.column("time_s"), positions = oracle.column("position_m"),
             forces = oracle.column("force_N");
  auto slave = made(smooth(), dt_s);
  double position_error = 0.0, force_error = 0.0;
  long step = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    ServoHydraulicSlave::Output output;
    for (const long until = std::lround(times[i] / dt_s); step < until; ++step) {
      output = slave.step(two_sines_mA((static_cast<double>(step) + 0.5) * dt_s));
    }
    position_error = std::max(position_error, std::fabs(output.position_m - positions[i]));
    force_error = std::max(force_error, std::fabs(output.pressure_force_N - forces[i]));
  }
  return {position_error, force_error};
}

TEST(ServoHydraulicSlave, MovesAsASecondIntegratorSays) {
  const auto [position_m, force_N] = error_against_oracle(step_s);
  // Over a stroke of 16 mm and forces of 400 N.
  EXPECT_LT(position_m, 2e-6);
  EXPECT_LT(force_N, 2.0);
}

TEST(ServoHydraulicSlave, HalvingTheStepQuartersTheError) {
  const auto [coarse_m, coarse_N] = error_against_oracle(2.0 * step_s);
  const auto [fine_m, fine_N] = error_against_oracle(step_s);
  // The kinks of overlap and of the turning flow leave less than the full second order.
  EXPECT_GT(coarse_m / fine_m, 2.5);
  EXPECT_GT(coarse_N / fine_N, 2.5);
}

TEST(ServoHydraulicSlave, RunsAsFastAsTheOrificesLetTheOil) {
  auto params = smooth();
  params.cylinder.friction.viscous_N_s_per_m = 0.0;
  params.cylinder.leakage_m3_per_s_per_Pa = params.valve.leakage_m3_per_s_per_Pa = 0.0;
  params.valve.overlap = 0.0;
  auto slave = made(params);
  slave.reset(-0.05);
  for (int i = 0; i < 15000; ++i) slave.step(7.5);
  // Without load each edge takes half of the supply's pressure.
  const double flow = 0.5 * 3.17e-4 * std::sqrt((21e6 - 1e5) / 7e6);
  EXPECT_NEAR(slave.cylinder().state().velocity_m_per_s, flow / 9.42e-4, 1e-3 * flow / 9.42e-4);
}

TEST(ServoHydraulicSlave, OilAndMassRingAtTheirNaturalFrequency) {
  auto params = smooth();
  params.cylinder.friction.viscous_N_s_per_m = 0.0;
  params.cylinder.leakage_m3_per_s_per_Pa = params.valve.leakage_m3_per_s_per_Pa = 0.0;
  params.valve.natural_frequency_Hz = 2000.0;
  auto slave = made(params, 2e-6);
  for (int i = 0; i < 1000; ++i) slave.step(3.0);
  for (int i = 0; i < 2000; ++i) slave.step(0.0);
  // The overlap has shut the chambers: now only oil and mass play.
  std::vector<double> crossings_s;
  double before = slave.cylinder().state().velocity_m_per_s;
  for (int i = 0; i < 25000; ++i) {
    slave.step(0.0);
    const double now = slave.cylinder().state().velocity_m_per_s;
    if (before < 0.0 && now >= 0.0) crossings_s.push_back(2e-6 * (i - now / (now - before)));
    before = now;
  }
  ASSERT_GT(crossings_s.size(), 5u);
  const double period_s = (crossings_s.back() - crossings_s.front()) / static_cast<double>(crossings_s.size() - 1);
  const double volume_m3 = 2e-5 + 9.42e-4 * 0.1;
  const double omega = std::sqrt(2.0 * 7e8 * 9.42e-4 * 9.42e-4 / volume_m3 / 6.8);
  EXPECT_NEAR(2.0 * std::numbers::pi / period_s, omega, 2e-3 * omega);
}

TEST(ServoHydraulicSlave, PressesOntoItsEndStopWithTheWholeSupply) {
  auto slave = made({});
  slave.reset(0.099);
  ServoHydraulicSlave::Output output;
  for (int i = 0; i < 50000; ++i) output = slave.step(15.0);
  const double stall_N = (21e6 - 1e5) * 9.42e-4;
  EXPECT_NEAR(output.pressure_force_N, stall_N, 0.01 * stall_N);
  // What is left over is no more than dry friction.
  EXPECT_NEAR(output.pressure_force_N, -output.end_stop_force_N, 250.0);
  EXPECT_NEAR(output.position_m, 0.1 + stall_N / 5e7, 1e-5);
}

TEST(ServoHydraulicSlave, StaticFrictionHoldsThePistonExactly) {
  auto params = ServoHydraulicSlave::Params{};
  params.cylinder.friction.static_N = params.cylinder.friction.coulomb_N = 1e5;
  auto slave = made(params);
  slave.reset(0.03);
  for (int i = 0; i < 20000; ++i) {
    ASSERT_EQ(slave.step(15.0).position_m, 0.03);
  }
}

TEST(ServoHydraulicSlave, TheOilNeverPulls) {
  auto slave = made({});
  for (int i = 0; i < 60000; ++i) {
    slave.step((i / 700) % 2 == 0 ? 15.0 : -15.0);
    for (const double pressure_Pa : slave.cylinder().state().pressure_Pa) ASSERT_GE(pressure_Pa, 0.0);
  }
}

TEST(ServoHydraulicSlave, TheValveFollowsItsCurrentAsASecondOrderSystem) {
  constexpr double dt_s = 1e-6;
  auto valve = ServoValve::make({.damping_ratio = 0.5, .overlap = 0.0}, Seconds{dt_s}).value();
  const double omega = 2.0 * std::numbers::pi * 100.0, damped = omega * std::sqrt(0.75);
  for (int i = 1; i <= 20000; ++i) {
    const double opening = valve.step(7.5);
    const double t = dt_s * i;
    const double expected =
        0.5 * (1.0 - std::exp(-0.5 * omega * t) * (std::cos(damped * t) + 0.5 * omega / damped * std::sin(damped * t)));
    ASSERT_NEAR(opening, expected, 1e-6);
  }
}

TEST(ServoHydraulicSlave, SensorsReadPositionAndForceWithinTheirNoise) {
  auto slave = made({});
  slave.reset(0.02);
  double worst_m = 0.0, worst_N = 0.0;
  for (int i = 0; i < 1000; ++i) {
    slave.step(0.0);
    const auto reading = slave.measure();
    worst_m = std::max(worst_m, std::fabs(reading.position_m - 0.02));
    worst_N = std::max(worst_N, std::fabs(reading.pressure_force_N));
  }
  EXPECT_GT(worst_m, 3e-6);
  EXPECT_LT(worst_m, 6.0 * 3e-6);
  EXPECT_LT(worst_N, 6.0 * std::sqrt(2.0) * 2.5e4 * 9.42e-4);
}

TEST(ServoHydraulicSlave, RefusesAStepThatCannotFollowItsOil) {
  const auto slave = ServoHydraulicSlave::make({}, Seconds{1e-4});
  ASSERT_FALSE(slave);
  EXPECT_EQ(slave.error().parameter, "cylinder.dead_volume_m3");
  EXPECT_NE(slave.error().message.find("s would do"), std::string::npos);
}

TEST(ServoHydraulicSlave, RefusesPartsThatContradictOneAnother) {
  ServoHydraulicSlave::Params params;
  params.cylinder.tank_Pa = params.cylinder.supply_Pa;
  EXPECT_EQ(ServoHydraulicSlave::make(params, Seconds{step_s}).error().parameter, "cylinder.tank_Pa");
  params = {};
  params.cylinder.friction.static_N = 10.0;
  EXPECT_EQ(ServoHydraulicSlave::make(params, Seconds{step_s}).error().parameter, "cylinder.friction.static_N");
}

}  // namespace servo_hydraulic_slave_test
}  // namespace tactus::mechanics
