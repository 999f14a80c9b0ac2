// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/amplifier.hpp>
#include <tactus/kernel/mechanics/encoder.hpp>
#include <tactus/kernel/mechanics/force_sensor.hpp>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace transducers_test {

static_assert(Element<Encoder>);
static_assert(Element<CurrentAmplifier>);
static_assert(Element<ForceSensor>);

TEST(Encoder, ReportsTheNearestCountAndErrsByHalfACountAtMostAndNotOnAverage) {
  constexpr double resolution_m = 1e-5;
  auto encoder = Encoder::make({.resolution_m = resolution_m}, Seconds{200e-6}).value();
  double mean_m = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double position_m = -2e-4 + 4e-8 * (i + 0.5);
    const double reported_m = encoder.step(position_m);
    ASSERT_LE(std::fabs(reported_m - position_m), 0.5 * resolution_m * (1.0 + 1e-9));
    ASSERT_NEAR(reported_m / resolution_m, std::nearbyint(reported_m / resolution_m), 1e-9);
    mean_m += (reported_m - position_m) / 10000.0;
  }
  EXPECT_NEAR(mean_m, 0.0, 1e-3 * resolution_m);
}

TEST(Encoder, APositionThatTremblesAboutZeroReadsZero) {
  auto encoder = Encoder::make({.resolution_m = 1e-5}, Seconds{200e-6}).value();
  EXPECT_EQ(encoder.step(4.9e-6), 0.0);
  EXPECT_EQ(encoder.step(-4.9e-6), 0.0);
}

TEST(Encoder, AResolutionOfZeroIsAnIdealSensor) {
  auto encoder = Encoder::make({.resolution_m = 0.0}, Seconds{200e-6}).value();
  EXPECT_EQ(encoder.step(1.23456789e-4), 1.23456789e-4);
}

TEST(CurrentAmplifier, AnswersAStepExactlyAsTheFirstOrderLagAtAnyStepSize) {
  constexpr double bandwidth_Hz = 1000.0;
  for (const double dt_s : {1e-6, 40e-6, 200e-6, 5e-3}) {
    auto amplifier =
        CurrentAmplifier::make({.gain = 0.98, .bandwidth_Hz = bandwidth_Hz, .limit_N = 5.0}, Seconds{dt_s}).value();
    const double rate = 2.0 * std::numbers::pi * bandwidth_Hz;
    for (int n = 1; n <= 200; ++n) {
      // The mean over the step, from the integral of the exponential, and the force at its end.
      const double before = std::exp(-rate * dt_s * (n - 1)), after = std::exp(-rate * dt_s * n);
      const double mean_N = 0.98 * 2.0 * (1.0 - (before - after) / (rate * dt_s));
      ASSERT_NEAR(amplifier.step(2.0), mean_N, 1e-12) << dt_s << " s, step " << n;
      ASSERT_NEAR(amplifier.applied_force_N(), 0.98 * 2.0 * (1.0 - after), 1e-12) << dt_s << " s, step " << n;
    }
  }
}

TEST(CurrentAmplifier, NeverAppliesMoreThanItsLimitAndRecoversAtOnce) {
  const CurrentAmplifier::Params params{.gain = 1.0, .bandwidth_Hz = 1000.0, .limit_N = 1.5};
  auto amplifier = CurrentAmplifier::make(params, Seconds{40e-6}).value();
  for (int n = 0; n < 1000; ++n) ASSERT_LE(std::fabs(amplifier.step(n < 500 ? 100.0 : 2.0)), 1.5);
  EXPECT_NEAR(amplifier.step(2.0), 1.5, 1e-12);
  const double decay = std::exp(-2.0 * std::numbers::pi * 1000.0 * 40e-6);
  amplifier.step(0.0);
  EXPECT_NEAR(amplifier.applied_force_N(), 1.5 * decay, 1e-12) << "no wind-up beyond the limit";
  for (int n = 0; n < 1000; ++n) amplifier.step(-100.0);
  EXPECT_NEAR(amplifier.step(-100.0), -1.5, 1e-12);
}

ForceSensor sensor(ForceSensor::Params params, double dt_s = 40e-6) {
  return ForceSensor::make(params, Seconds{dt_s}).value();
}

TEST(ForceSensor, ItsAnalogueOutputHasLostThreeDecibelsAtItsBandwidth) {
  for (const double bandwidth_Hz : {100.0, 1000.0, 10000.0}) {
    const auto response = measured_response(sensor({.bandwidth_Hz = bandwidth_Hz}), bandwidth_Hz, 40e-6);
    EXPECT_NEAR(std::abs(response), std::numbers::sqrt2 / 2.0, 1e-9);
  }
}

TEST(ForceSensor, WithoutNoiseAReadingIsTheAnalogueOutputPlusTheOffset) {
  auto element = sensor({.offset_N = 0.25});
  EXPECT_EQ(element.sample(), 0.25);
  for (int n = 0; n < 5; ++n) {
    const double analogue_N = element.step(2.0);
    EXPECT_EQ(element.sample(), analogue_N + 0.25);
  }
}

TEST(ForceSensor, SaturatesEitherWay) {
  auto element = sensor({.noise_rms_N = 0.1, .limit_N = 5.0});
  for (int n = 0; n < 1000; ++n) element.step(50.0);
  EXPECT_EQ(element.sample(), 5.0);
  for (int n = 0; n < 2000; ++n) element.step(-50.0);
  EXPECT_EQ(element.sample(), -5.0);
}

std::vector<double> readings(ForceSensor element, int count, int substeps) {
  std::vector<double> numbers_N;
  for (int i = 0; i < count; ++i) {
    for (int n = 0; n < substeps; ++n) element.step(0.0);
    numbers_N.push_back(element.sample());
  }
  return numbers_N;
}

TEST(ForceSensor, TheNoiseIsWhiteAndHasTheStatedRms) {
  const auto noise_N = readings(sensor({.noise_rms_N = 0.02}), 50000, 1);
  double square = 0.0;
  double lagged = 0.0;
  for (std::size_t i = 1; i < noise_N.size(); ++i) {
    square += noise_N[i] * noise_N[i];
    lagged += noise_N[i] * noise_N[i - 1];
  }
  EXPECT_NEAR(std::sqrt(square / 50000.0), 0.02, 0.02 * 0.015);
  EXPECT_LT(std::fabs(lagged / square), 4.0 / std::sqrt(50000.0));
}

TEST(ForceSensor, TheNoiseDoesNotDependOnHowFinelyThePlantIsSteppedButOnTheSeed) {
  const ForceSensor::Params params{.noise_rms_N = 0.02, .seed = 9};
  EXPECT_EQ(readings(sensor(params), 100, 1), readings(sensor(params, 8e-6), 100, 5));
  EXPECT_NE(readings(sensor(params), 100, 1), readings(sensor({.noise_rms_N = 0.02, .seed = 10}), 100, 1));
}

TEST(ForceSensor, ResetBringsTheNoiseBackToItsBeginning) {
  auto element = sensor({.noise_rms_N = 0.02});
  const auto first = readings(element, 50, 3);
  for (int n = 0; n < 20; ++n) {
    element.step(1.0);
    element.sample();
  }
  element.reset();
  EXPECT_EQ(readings(element, 50, 3), first);
}

TEST(ForceSensor, ABandwidthThatTheSubstepsCannotCarryIsRefused) {
  const auto refused = ForceSensor::make({.bandwidth_Hz = 12500.0}, Seconds{40e-6});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().parameter, "bandwidth_Hz");
}

}  // namespace transducers_test
}  // namespace tactus::mechanics
