// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/cable_driven_master.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "tests/mechanics/reference_chain.hpp"
#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace cable_driven_master_test {

static_assert(Element<CableDrivenMaster>);

constexpr double step_s = 40e-6;

ReferenceChain in_a_hand() {
  ReferenceChain reference;
  reference.grip_N_per_m = 40.0;
  reference.grip_N_s_per_m = 23.0;
  return reference;
}

/// A master with an amplifier that answers at once.
CableDrivenMaster master(const ReferenceChain& reference) {
  CableDrivenMaster::Params params;
  params.mechanism = reference.params();
  params.amplifier.bandwidth_Hz = 1e9;
  return CableDrivenMaster::make(params, reference.grip(), Seconds{step_s}).value();
}

double momentum(const CableDrivenMaster& device, const ReferenceChain& reference) {
  const auto& v = device.mechanism().state().velocity_m_per_s;
  return reference.motor_kg * v[0] + reference.drum_kg * v[1] + reference.tip_kg * v[2];
}

TEST(CableDrivenMaster, ASteadyForceDeflectsTheHandByTheGripAndTheMotorByTheChainToo) {
  const ReferenceChain reference = in_a_hand();
  CableDrivenMaster device = master(reference);
  constexpr double force_N = 0.1;
  for (int i = 0; i < 400000; ++i) device.step({.commanded_force_N = force_N});
  EXPECT_NEAR(device.mechanism().tip_position_m(), force_N / 40.0, 1e-8);
  EXPECT_NEAR(device.mechanism().motor_position_m(), force_N * (1.0 / 40.0 + 1.0 / 3950.0 + 1.0 / 39500.0), 1e-8);
}

TEST(CableDrivenMaster, AHandThatHoldsAgainstTheMotorIsMeasuredToPushTowardTheEnvironmentWithTheDisplayedForce) {
  CableDrivenMaster device = master(in_a_hand());
  for (int i = 0; i < 400000; ++i) device.step({.commanded_force_N = -0.3});
  EXPECT_NEAR(device.measure().hand_force_N, 0.3, 1e-9);
}

/// Amplitude of the motor's motion over that of a sine on the motor, once settled.
double swept_gain(const ReferenceChain& reference, double frequency_Hz) {
  CableDrivenMaster device = master(reference);
  constexpr double amplitude_N = 0.01;
  constexpr int settling_steps = 25000, measured_steps = 50000;
  std::complex<double> sum = 0.0;
  for (int i = 0; i < settling_steps + measured_steps; ++i) {
    const double turn = 2.0 * std::numbers::pi * frequency_Hz * step_s;
    const auto out = device.step({.commanded_force_N = amplitude_N * std::cos(turn * (i + 0.5))});
    if (i >= settling_steps) sum += out.motor_position_m * std::polar(1.0, -turn * (i + 1));
  }
  return 2.0 * std::abs(sum) / (measured_steps * amplitude_N);
}

TEST(CableDrivenMaster, ASmallSweptSineMeetsTheClosedFormResponseWithItsPeakBetween74And75Hz) {
  const ReferenceChain reference = in_a_hand();
  for (const double frequency_Hz : {20.0, 40.0, 100.0, 200.0, 400.0}) {
    const double gain = reference.gain(frequency_Hz);
    // Below its peak near 480 Hz the cable mode amplifies the 0.06 % by which the step raises its frequency.
    EXPECT_NEAR(swept_gain(reference, frequency_Hz), gain, (frequency_Hz < 300.0 ? 2e-3 : 5e-3) * gain)
        << frequency_Hz << " Hz";
  }
  double peak_Hz = 0.0, peak = 0.0;
  for (double frequency_Hz = 72.0; frequency_Hz <= 77.0; frequency_Hz += 0.5) {
    const double gain = swept_gain(reference, frequency_Hz);
    EXPECT_NEAR(gain, reference.gain(frequency_Hz), 2e-3 * gain) << frequency_Hz << " Hz";
    if (gain > peak) {
      peak = gain;
      peak_Hz = frequency_Hz;
    }
  }
  EXPECT_GE(peak_Hz, 74.0);
  EXPECT_LE(peak_Hz, 75.0);
}

TEST(CableDrivenMaster, AHandThatMovesItsGripTakesTheHandleAlong) {
  CableDrivenMaster device = master(in_a_hand());
  constexpr double speed_m_per_s = 0.1;
  for (int i = 0; i < 100000; ++i) {
    device.step({.grip_position_m = speed_m_per_s * step_s * (i + 0.5), .grip_velocity_m_per_s = speed_m_per_s});
  }
  EXPECT_NEAR(device.mechanism().tip_position_m(), speed_m_per_s * step_s * 100000, 1e-6);
  EXPECT_NEAR(device.mechanism().tip_velocity_m_per_s(), speed_m_per_s, 1e-6);
}

TEST(CableDrivenMaster, TheAmplifierSaturatesAndLagsOnTheWayToTheMotor) {
  const ReferenceChain reference;
  CableDrivenMaster::Params params;
  params.mechanism = reference.params();
  params.amplifier = {.gain = 1.0, .bandwidth_Hz = 200.0, .limit_N = 2.0};
  CableDrivenMaster device = CableDrivenMaster::make(params, Seconds{step_s}).value();
  constexpr int steps = 2500;
  for (int i = 0; i < steps; ++i) device.step({.commanded_force_N = 1000.0});
  // A first-order lag withholds its limit for one time constant; within one step of that.
  const double lag_s = 1.0 / (2.0 * std::numbers::pi * 200.0);
  EXPECT_NEAR(momentum(device, reference), 2.0 * (steps * step_s - lag_s), 2.0 * step_s);
}

TEST(CableDrivenMaster, ASteadyForceOfTheHandlesActuatorDeflectsTheHandByTheGripAndTheMotorNoFurther) {
  const ReferenceChain reference = in_a_hand();
  CableDrivenMaster device = master(reference);
  constexpr double force_N = 0.1;
  for (int i = 0; i < 400000; ++i) device.step({.commanded_handle_force_N = force_N});
  EXPECT_NEAR(device.mechanism().tip_position_m(), force_N / 40.0, 1e-8);
  EXPECT_NEAR(device.mechanism().motor_position_m(), force_N / 40.0, 1e-8);
}

TEST(CableDrivenMaster, TheHandlesActuatorSaturatesAndLagsOnItsOwn) {
  const ReferenceChain reference;
  CableDrivenMaster::Params params;
  params.mechanism = reference.params();
  params.handle_actuator = {.gain = 1.0, .bandwidth_Hz = 100.0, .limit_N = 0.5};
  CableDrivenMaster device = CableDrivenMaster::make(params, Seconds{step_s}).value();
  constexpr int steps = 2500;
  for (int i = 0; i < steps; ++i) device.step({.commanded_handle_force_N = -1000.0});
  const double lag_s = 1.0 / (2.0 * std::numbers::pi * 100.0);
  EXPECT_NEAR(momentum(device, reference), -0.5 * (steps * step_s - lag_s), 0.5 * step_s);
  device.reset();
  device.step({});
  EXPECT_EQ(momentum(device, reference), 0.0);
}

TEST(CableDrivenMaster, TheEncoderReportsTheMotorToHalfACount) {
  CableDrivenMaster device = CableDrivenMaster::make({}, Seconds{step_s}).value();
  double travelled_m = 0.0;
  for (int i = 0; i < 2000; ++i) {
    device.step({.commanded_force_N = 0.5});
    const double read_m = device.measure().motor_position_m;
    ASSERT_NEAR(read_m, device.mechanism().motor_position_m(), 0.5e-5 + 1e-12);
    ASSERT_NEAR(read_m / 1e-5, std::round(read_m / 1e-5), 1e-6);
    travelled_m = read_m;
  }
  EXPECT_GT(travelled_m, 1e-3);
}

TEST(CableDrivenMaster, AfterAResetItRestsWhereItWasPut) {
  const ReferenceChain reference = in_a_hand();
  CableDrivenMaster::Params params;
  CableDrivenMaster device = CableDrivenMaster::make(params, reference.grip(), Seconds{step_s}).value();
  for (int i = 0; i < 1000; ++i) device.step({.commanded_force_N = 2.0});
  device.reset(0.04);
  EXPECT_EQ(device.measure().motor_position_m, 0.04);
  for (int i = 0; i < 100; ++i) device.step({.grip_position_m = 0.04});
  EXPECT_EQ(device.mechanism().motor_position_m(), 0.04);
  EXPECT_EQ(device.mechanism().tip_position_m(), 0.04);
}

TEST(CableDrivenMaster, NobodysHandIsMeasuredToPushWithTheSensorsOffsetAlone) {
  CableDrivenMaster::Params params;
  params.force_sensor.offset_N = 0.02;
  CableDrivenMaster device = CableDrivenMaster::make(params, Seconds{step_s}).value();
  for (int i = 0; i < 1000; ++i) device.step({.commanded_force_N = 1.0});
  EXPECT_EQ(device.measure().hand_force_N, 0.02);
}

TEST(CableDrivenMaster, AForceSensorThatTheSubstepsCannotCarryIsRefusedByName) {
  CableDrivenMaster::Params params;
  params.force_sensor.bandwidth_Hz = 20000.0;
  const auto refused = CableDrivenMaster::make(params, Seconds{step_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "force_sensor.bandwidth_Hz");
}

TEST(CableDrivenMaster, AGripTooStiffForTheStepIsNamedAsTheGrips) {
  const auto device =
      CableDrivenMaster::make({}, {.stiffness_N_per_m = 1e9, .damping_N_s_per_m = 23.0}, Seconds{step_s});
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().parameter, "grip.stiffness_N_per_m");
}

}  // namespace cable_driven_master_test
}  // namespace tactus::mechanics
