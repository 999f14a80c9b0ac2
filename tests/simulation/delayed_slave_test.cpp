// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/delayed_slave.hpp>

#include <cmath>
#include <numbers>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::simulation {
namespace delayed_slave_test {

TEST(DelayedSlave, FollowsAChirpAsScipySays) {
  const OracleTable oracle("simulation_delayed_slave");
  const Path chirp = [](double t) {
    const double rate = 3.5 / 3.0, phase = 2.0 * std::numbers::pi * (0.5 + 0.5 * rate * t) * t;
    return PathPoint{.position_m = 0.1 * std::sin(phase),
                     .velocity_m_per_s = 0.2 * std::numbers::pi * (0.5 + rate * t) * std::cos(phase)};
  };
  const SlaveRecord record = follow({}, chirp, 3.0, 2e-4).value();
  const auto time_s = oracle.column("time_s");
  const auto command = oracle.column("command"), position = oracle.column("position");
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const auto tick = static_cast<std::size_t>(std::lround(time_s[i] / 2e-4));
    ASSERT_LT(tick, record.command.size());
    EXPECT_NEAR(record.command[tick], command[i], 1e-6) << time_s[i];
    EXPECT_NEAR(record.position[tick], position[i], 1e-8) << time_s[i];
  }
}

TEST(DelayedSlave, ThePaperNumbersLeaveFourTenthsOfADegree) { EXPECT_NEAR(phase_margin_deg({}), 0.36, 0.01); }

TEST(DelayedSlave, TooManyStepsAreRefused) {
  DelayedSlaveParams params;
  params.actuator_delay_s = 1e-9;
  params.sensor_delay_s = 0.0;
  const auto record = follow(
      params, [](double) { return PathPoint{}; }, 20.0, 2e-4);
  ASSERT_FALSE(record);
  EXPECT_EQ(record.error().parameter, "slave.actuator_delay_s");
}

}  // namespace delayed_slave_test
}  // namespace tactus::simulation
