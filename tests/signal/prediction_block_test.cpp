// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/prediction_block.hpp>

#include <cmath>
#include <numbers>

#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

namespace tactus::signal {
namespace prediction_block_test {

constexpr double dt_s = 1e-4;

PredictionCascade::Params cascade(std::int64_t blocks, Discretisation discretisation = Discretisation::tustin) {
  return {.blocks = blocks, .block = {.time_constant_s = 0.0018, .discretisation = discretisation}};
}

/// Mean of (1 + x²)^(−k) over the unit circle, where x = c·tan(φ), φ uniform, is a Cauchy variable of scale c.
double mean_power(int k, double c) {
  const double d = 1.0 + c;
  switch (k) {
    case 0:
      return 1.0;
    case 1:
      return 1.0 / d;
    case 2:
      return (c + 2.0) / (2.0 * d * d);
    case 3:
      return (3.0 * c * c + 9.0 * c + 8.0) / (8.0 * d * d * d);
    default:
      return (5.0 * c * c * c + 20.0 * c * c + 29.0 * c + 16.0) / (16.0 * d * d * d * d);
  }
}

TEST(PredictionCascade, WhiteNoiseIsAmplifiedAsTheClosedFormSays) {
  // |H|² = 4 − 3/(1 + x²) under the bilinear transform, so the mean of its n-th power is a binomial sum.
  const double c = 2.0 * 0.0018 / dt_s;
  for (int n = 0; n <= 4; ++n) {
    double power = 0.0, binomial = 1.0;
    for (int k = 0; k <= n; ++k) {
      power += binomial * std::pow(4.0, n - k) * std::pow(-3.0, k) * mean_power(k, c);
      binomial *= static_cast<double>(n - k) / (k + 1.0);
    }
    EXPECT_NEAR(white_noise_gain(cascade(n), Seconds{dt_s}).value(), std::sqrt(power), 1e-9 * std::sqrt(power)) << n;
  }
}

TEST(PredictionCascade, AlternatingSamplesGrowByTwoToTheNumberOfBlocks) {
  for (int n = 0; n <= 4; ++n) {
    PredictionCascade blocks = PredictionCascade::make(cascade(n), Seconds{dt_s}).value();
    double last = 0.0;
    for (int tick = 0; tick < 20000; ++tick) last = blocks.step(tick % 2 == 0 ? 1.0 : -1.0);
    EXPECT_NEAR(std::abs(last), std::pow(2.0, n), 1e-9);
  }
}

TEST(PredictionCascade, TheSampledResponseIsTheContinuousOneAtTheWarpedFrequency) {
  for (const double frequency_Hz : {1.0, 10.0, 300.0}) {
    const auto blocks = PredictionCascade::make(cascade(3), Seconds{dt_s}).value();
    const std::complex<double> warped(0.0, 2.0 / dt_s * std::tan(std::numbers::pi * frequency_Hz * dt_s));
    EXPECT_NEAR(std::abs(measured_response(blocks, frequency_Hz, dt_s, 5000) - response(cascade(3), warped)), 0.0,
                1e-9);
  }
}

TEST(PredictionBlock, TheStepResponseOfTheExactFormIsTwoLessTheDecay) {
  auto block =
      PredictionBlock::make({.time_constant_s = 0.002, .discretisation = Discretisation::exact}, Seconds{dt_s}).value();
  for (int tick = 0; tick < 200; ++tick) EXPECT_NEAR(block.step(1.0), 1.0 + std::exp(-tick * dt_s / 0.002), 1e-12);
}

TEST(PredictionCascade, ARampIsSeenByTheLeadAhead) {
  PredictionCascade blocks = PredictionCascade::make(cascade(2), Seconds{dt_s}).value();
  double ahead = 0.0;
  for (int tick = 0; tick <= 2000; ++tick) ahead = blocks.step(tick * dt_s);
  EXPECT_NEAR(ahead - 2000 * dt_s, 2.0 * 0.0018, 1e-12);
}

TEST(PredictionCascade, InTheUsableBandTheErrorStaysBelowItsTolerance) {
  // Third term of the series: the error is n·3/2·(ω·Tp)².
  const double band_Hz = usable_band_Hz(cascade(2), 1e-3);
  EXPECT_NEAR(band_Hz, std::sqrt(1e-3 / 3.0) / (2.0 * std::numbers::pi * 0.0018), 0.01 * band_Hz);
}

}  // namespace prediction_block_test
}  // namespace tactus::signal
