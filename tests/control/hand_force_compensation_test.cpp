// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/control/stages/hand_force_compensation.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

namespace tactus::control {
namespace hand_force_compensation_test {

using Complex = std::complex<double>;
constexpr Seconds tick{200e-6};

Complex s_at(double frequency_Hz) { return {0.0, 2.0 * std::numbers::pi * frequency_Hz}; }

/// Force on the hand over force of the motor of the whole linear chain, link by link from the hand inward: an
/// impedance in series with a spring passes spring / (spring + impedance) of the motion.
Complex chain(const MasterModel& m, Complex s) {
  const Complex hand = m.hand.damping_N_s_per_m * s + m.hand.stiffness_N_per_m;
  const Complex linkage = m.linkage.damping_N_s_per_m * s + m.linkage.stiffness_N_per_m;
  const Complex cable = m.cable.damping_N_s_per_m * s + m.cable.stiffness_N_per_m;
  const Complex at_handle = m.handle.mass_kg * s * s + hand;
  const Complex to_handle = linkage / (linkage + at_handle);
  const Complex at_drum = m.drum.mass_kg * s * s + at_handle * to_handle;
  const Complex to_drum = cable / (cable + at_drum);
  const Complex at_motor = m.motor.mass_kg * s * s + at_drum * to_drum;
  return hand * to_handle * to_drum / at_motor;
}

/// What the element makes of a sine, once settled, from a fit over whole periods of every multiple of 5 Hz.
Complex response(HandForceCompensation element, double frequency_Hz) {
  constexpr int settling = 5000, window = 5000;
  const double angle = 2.0 * std::numbers::pi * frequency_Hz * tick.value;
  Complex sum = 0.0;
  for (int n = 0; n < settling + window; ++n) {
    const double out = element.step(std::cos(angle * n));
    if (n >= settling) sum += out * std::polar(1.0, -angle * n);
  }
  return sum * (2.0 / window);
}

HandForceCompensation made(double band_Hz) {
  return HandForceCompensation::make({.master = {}, .band_Hz = band_Hz}, tick).value();
}

double decibels(Complex gain) { return 20.0 * std::log10(std::abs(gain)); }

TEST(HandForceCompensation, FlattensTheWayFromMotorToHandUpToItsBand) {
  const HandForceCompensation compensation = made(200.0);
  EXPECT_GT(decibels(chain({}, s_at(75.0))), 8.0);
  EXPECT_LT(decibels(chain({}, s_at(200.0))), -15.0);
  for (const double frequency_Hz : {5.0, 20.0, 50.0, 75.0, 100.0}) {
    EXPECT_NEAR(decibels(chain({}, s_at(frequency_Hz)) * response(compensation, frequency_Hz)), 0.0, 1.0)
        << frequency_Hz << " Hz";
  }
  // 3 dB by the band and 1 dB by handle and hand.
  EXPECT_NEAR(decibels(chain({}, s_at(200.0)) * response(compensation, 200.0)), -4.0, 0.5);
}

TEST(HandForceCompensation, PassesAConstantForceAndAsksAboveTheBandForTheSquareOfBandOverMode) {
  HandForceCompensation compensation = made(200.0);
  for (int n = 0; n < 10; ++n) EXPECT_NEAR(compensation.step(0.7), 0.7, 1e-12) << n;
  const double mode_Hz = std::abs(linkage_mode({})) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(std::abs(response(made(200.0), 1500.0)), std::pow(200.0 / mode_Hz, 2), 0.2);
}

TEST(HandForceCompensation, UndoesARootOfTheCharacteristicPolynomialOfTheTwoMassChain) {
  const MasterModel m;
  const Complex s = linkage_mode(m);
  const Complex inner = (m.motor.mass_kg + m.drum.mass_kg) * s * s;
  const Complex linkage = m.linkage.damping_N_s_per_m * s + m.linkage.stiffness_N_per_m;
  const Complex outer = m.handle.mass_kg * s * s + m.hand.damping_N_s_per_m * s + m.hand.stiffness_N_per_m;
  EXPECT_GT(s.imag(), 0.0);
  EXPECT_LT(std::abs((inner + linkage) * (outer + linkage) - linkage * linkage),
            1e-9 * m.linkage.stiffness_N_per_m * m.linkage.stiffness_N_per_m);
}

TEST(HandForceCompensation, IsOffByDefaultAndChangesNoBit) {
  HandForceCompensation compensation = made(0.0);
  EXPECT_FALSE(compensation.on());
  for (const double force_N : {0.1, -0.3, 1e9}) EXPECT_EQ(compensation.step(force_N), force_N);
}

TEST(HandForceCompensation, RefusesABandBeyondTheServoAndAModelWithoutAMode) {
  const auto beyond = HandForceCompensation::make({.master = {}, .band_Hz = 2500.0}, tick);
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().parameter, "band_Hz");

  MasterModel rubber;
  rubber.linkage.stiffness_N_per_m = 10.0;
  rubber.linkage.damping_N_s_per_m = 50.0;
  const auto without = HandForceCompensation::make({.master = rubber, .band_Hz = 100.0}, tick);
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().code, ErrorCode::inconsistent);

  PositionForceMaster::Params params;
  params.hand_compensation_Hz = 2500.0;
  EXPECT_EQ(PositionForceMaster::make(params, tick).error().parameter, "hand_compensation_Hz");
}

TEST(HandForceCompensation, WhatItAsksOfTheMotorStaysWithinTheForceLimit) {
  PositionForceMaster::Params params;
  params.force_gain = 10.0;
  params.hand_compensation_Hz = 400.0;
  auto master = PositionForceMaster::make(params, tick).value();
  double largest_N = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const double force_N = n % 20 < 10 ? 1.0 : 0.0;
    const MasterOutput output =
        master.step({.motor_position_m = 0.0, .arrival = {.message = {.force_N = force_N}, .fresh = true}});
    largest_N = std::max(largest_N, std::abs(output.motor_force_N));
  }
  EXPECT_EQ(largest_N, params.force_limit_N);
}

}  // namespace hand_force_compensation_test
}  // namespace tactus::control
