// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/columns.hpp>
#include <tactus/identification/diagnosis/diagnosis.hpp>
#include <tactus/identification/diagnosis/motor_power.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>

#include <gtest/gtest.h>

/// What the force of the follower's motor says about its own sign.
namespace tactus::diagnosis {
namespace motor_power_test {

/// Ten seconds at 1 kHz: 20 mm to and fro at 1.3 Hz under F = k·x + b·v + m·a, of which x is `late_s` old.
Signals moved_by(double stiffness_N_per_m, double damping_N_s_per_m, double mass_kg, double late_s = 0.0) {
  constexpr double turns = 2.0 * std::numbers::pi * 1.3, step_s = 1e-3, size_m = 0.02;
  constexpr std::size_t samples = 10000;
  Channel position{.name = "follower", .values = {}, .step = 1e-6}, force{.name = "motor", .values = {}, .step = 1e-3};
  for (std::size_t i = 0; i < samples; ++i) {
    const double at = turns * step_s * static_cast<double>(i);
    position.values.push_back(size_m * std::sin(at));
    force.values.push_back(size_m *
                           (stiffness_N_per_m * std::sin(at - turns * late_s) +
                            damping_N_s_per_m * turns * std::cos(at) - mass_kg * turns * turns * std::sin(at)));
  }
  Signals signals{.channels = {}, .sample_time = Seconds{step_s}, .samples = samples, .rotary = false};
  signals.channels[index_of(Role::slave_position)] = std::move(position);
  signals.channels[index_of(Role::slave_force)] = std::move(force);
  return signals;
}

bool is_doubted(const Signals& signals) {
  return diagnose(signals).verdict.find("--slave-force-sign -1") != std::string::npos;
}

TEST(MotorPower, ThePhaseIsThatOfDamperMassAndSpring) {
  EXPECT_NEAR(motor_phase_deg(moved_by(0.0, 5.0, 0.0)).value(), 0.0, 1.0);
  EXPECT_NEAR(motor_phase_deg(moved_by(0.0, 0.0, 0.5)).value(), 90.0, 1.0);
  EXPECT_NEAR(motor_phase_deg(moved_by(100.0, 0.0, 0.0)).value(), -90.0, 1.0);
  EXPECT_NEAR(motor_phase_deg(moved_by(0.0, -5.0, 0.0)).value(), 180.0, 1.0);
}

TEST(MotorPower, OnlyAForceThatBrakesWhatMovesIsDoubted) {
  EXPECT_TRUE(is_doubted(moved_by(0.0, -5.0, 0.0)));
  EXPECT_TRUE(is_doubted(moved_by(0.0, -5.0, -0.2))) << "friction and some mass, both reversed";
  EXPECT_FALSE(is_doubted(moved_by(0.0, 5.0, 0.2)));
  EXPECT_FALSE(is_doubted(moved_by(100.0, 0.0, 0.0))) << "a spring at the tip";
  // 40 ms at 1.3 Hz are 19 degrees: the spring then seems to give energy.
  EXPECT_FALSE(is_doubted(moved_by(100.0, 0.0, 0.0, 0.04)));
}

}  // namespace motor_power_test
}  // namespace tactus::diagnosis
