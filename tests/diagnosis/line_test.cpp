// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/line.hpp>
#include <tactus/identification/diagnosis/loop_gain.hpp>
#include <tactus/identification/diagnosis/signals.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace {

constexpr Seconds dt{1e-3};
constexpr double two_pi = 2.0 * std::numbers::pi;

std::vector<double> sine(double amplitude, double frequency_Hz, double phase_rad, std::size_t samples) {
  std::vector<double> values(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    values[i] = amplitude * std::cos(two_pi * frequency_Hz * 1e-3 * static_cast<double>(i) + phase_rad);
  }
  return values;
}

TEST(Line, BlocksTellAmplitudeAndPhaseOfASineOnARamp) {
  std::vector<double> values = sine(0.3, 17.0, 0.7, 4000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += 2.0 + 1e-3 * static_cast<double>(i);
  for (const Complex& block : line_in_blocks(values, 500, 17.0, dt)) {
    EXPECT_NEAR(std::abs(block), 0.3, 2e-3);
    EXPECT_NEAR(std::arg(block), 0.7, 0.01);
  }
}

TEST(Line, DemodulationFollowsAnEnvelope) {
  std::vector<double> values = sine(1.0, 20.0, 0.0, 4000);
  for (std::size_t i = 2000; i < values.size(); ++i) values[i] *= 0.25;
  const std::vector<Complex> line = demodulate(values, 20.0, dt);
  EXPECT_NEAR(std::abs(line[1000]), 1.0, 0.02);
  EXPECT_NEAR(std::abs(line[3000]), 0.25, 0.01);
}

TEST(Line, AQuarterOfAPeriodLaterIsNinetyDegreesBehind) {
  const auto first = line_in_blocks(sine(1.0, 8.0, 0.0, 4000), 500, 8.0, dt);
  const auto second = line_in_blocks(sine(5.0, 8.0, -0.5 * std::numbers::pi, 4000), 500, 8.0, dt);
  const Relation found = relation(first, second);
  EXPECT_NEAR(found.coherence, 1.0, 1e-6);
  EXPECT_NEAR(found.angle_rad, -0.5 * std::numbers::pi, 1e-3);
  EXPECT_NEAR(found.alignment, 0.0, 1e-3);
}

TEST(Line, ASpectrogramHoldsTheMeanSquareOfASine) {
  const Spectrogram found = spectrogram(sine(2.0, 62.5, 0.3, 4096), 512, 256, dt);
  double power = 0.0;
  for (const double line : found.power[3]) power += line;
  EXPECT_NEAR(power, 2.0, 0.02);
}

// Of a sine of amplitude A through a limit at M the first harmonic is (2/pi)(asin(M/A) + (M/A)·sqrt(1 − (M/A)²)).
TEST(LoopGain, DescribesALimitAsTheBooksDo) {
  for (const double ratio : {0.2, 0.5, 0.9}) {
    const double book = 2.0 / std::numbers::pi * (std::asin(ratio) + ratio * std::sqrt(1.0 - ratio * ratio));
    const double clipped = 0.5 - std::asin(ratio) / std::numbers::pi;  // share of a period at each end
    EXPECT_NEAR(describing_gain(clipped, clipped), book, 1e-12);
  }
  EXPECT_DOUBLE_EQ(describing_gain(0.0, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(describing_gain(0.6, 0.4), 0.0);
}

TEST(LoopGain, OfAClippedSineIsWhatTheLimitTookAway) {
  std::vector<double> force = sine(2.0, 23.0, 0.0, 8000);
  for (double& f : force) f = std::clamp(f, -1.0, 1.0);
  const auto found = loop_gain(force, false);
  ASSERT_TRUE(found);
  const double expected = std::numbers::pi / 2.0 / (std::asin(0.5) + 0.5 * std::sqrt(0.75));
  EXPECT_NEAR(found->value, expected, 0.08 * expected);
  EXPECT_LE(found->lower, found->value);
  EXPECT_GE(found->upper, found->value);
}

TEST(LoopGain, IsNotToldByAForceThatIsNeverAtAnEnd) {
  std::vector<double> force = sine(1.0, 23.0, 0.0, 8000);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] *= 0.5 + 0.5 * static_cast<double>(i % 4000) / 4000.0;
  force[10] = 3.0;
  force[20] = -3.0;
  EXPECT_FALSE(loop_gain(force, false));
}

TEST(Step, IsTheCountOfAnEncoderAndNotADigitOfTheFile) {
  std::vector<double> values;
  for (int i = 0; i < 500; ++i)
    values.push_back(std::round(1e6 * 3.7e-5 * std::floor(20.0 * std::sin(0.05 * i))) * 1e-6);
  EXPECT_NEAR(step_of(values), 3.7e-5, 1.5e-6);
  EXPECT_EQ(step_of({2.0, 2.0, 2.0}), 0.0);
}

}  // namespace
}  // namespace tactus::diagnosis
