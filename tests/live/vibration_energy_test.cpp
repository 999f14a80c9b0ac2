// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/vibration_energy.hpp>

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tactus::live {
namespace {

constexpr double dt_s = 2e-4;

/// Energy in one second of a force of 1 N and a motion of 1 mm at one frequency, where the force leads by an angle.
double energy_J(double frequency_Hz, double lead_rad) {
  auto energy = VibrationEnergy::make(Seconds{dt_s});
  EXPECT_TRUE(energy);
  const double rate = 2.0 * std::numbers::pi * frequency_Hz;
  for (int tick = 0; tick < 10000; ++tick) {
    if (tick == 5000) energy->begin();
    const double time_s = tick * dt_s;
    energy->step(std::sin(rate * (time_s + dt_s / 2.0) + lead_rad), 1e-3 * std::sin(rate * time_s));
  }
  return energy->energy_J();
}

TEST(VibrationEnergy, IsThatOfAForceThatPushesAlongWithTheMotionAndOfOneThatBrakesIt) {
  // Mean of F v over whole periods: 1 N · 1 mm · 2π · 100 Hz / 2. A displayed force pushes back where it is positive.
  const double expected_J = 0.5 * 1e-3 * 2.0 * std::numbers::pi * 100.0;
  EXPECT_NEAR(energy_J(100.0, -std::numbers::pi / 2.0), expected_J, 0.01 * expected_J);
  EXPECT_NEAR(energy_J(100.0, std::numbers::pi / 2.0), -expected_J, 0.01 * expected_J);
}

TEST(VibrationEnergy, IsNothingForASpring) { EXPECT_NEAR(energy_J(100.0, 0.0), 0.0, 1e-3); }

TEST(VibrationEnergy, LeavesSlowPressingOut) {
  const double all_J = 0.5 * 1e-3 * 2.0 * std::numbers::pi * 1.0;
  EXPECT_LT(std::fabs(energy_J(1.0, std::numbers::pi / 2.0)), 1e-3 * all_J);
}

TEST(VibrationEnergy, BeginsAtRestWhereverTheHandleIs) {
  auto energy = VibrationEnergy::make(Seconds{dt_s});
  ASSERT_TRUE(energy);
  energy->reset(0.5);
  for (int tick = 0; tick < 1000; ++tick) energy->step(tick < 500 ? 0.0 : 1.0, 0.5);
  EXPECT_NEAR(energy->energy_J(), 0.0, 1e-12);
}

}  // namespace
}  // namespace tactus::live
