// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/resample.hpp>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/recording/files.hpp"

namespace tactus::recording {
namespace {

Signal sampled(double sample_time_s, std::size_t samples, const std::function<double(double)>& curve) {
  Signal signal{.values = {}, .name = "force", .unit = "N", .sample_time_s = sample_time_s};
  for (std::size_t i = 0; i < samples; ++i) signal.values.push_back(curve(sample_time_s * static_cast<double>(i)));
  return signal;
}

double greatest_error(const Signal& signal, const std::function<double(double)>& curve) {
  double greatest = 0.0;
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    greatest = std::max(greatest, std::abs(signal.values[i] - curve(*signal.sample_time_s * static_cast<double>(i))));
  }
  return greatest;
}

TEST(Resample, AParabolaAtTwoKilohertzIsTheSameParabolaAtFive) {
  const auto parabola = [](double t) { return 3.0 - 200.0 * t + 4000.0 * t * t; };
  const auto fine = resample(sampled(0.0005, 101, parabola), Seconds(0.0002));
  ASSERT_TRUE(fine) << describe(fine.error());
  EXPECT_EQ(fine->values.size(), 251U);
  EXPECT_EQ(fine->sample_time_s, 0.0002);
  EXPECT_EQ(fine->unit, "N");
  EXPECT_LT(greatest_error(*fine, parabola), 1e-12);
}

TEST(Resample, OriginalSamplesAreKeptExactly) {
  const auto rough = [](double t) { return std::sin(1e7 * t * t); };
  const Signal coarse = sampled(0.0005, 2001, rough);
  const auto fine = resample(coarse, Seconds(0.0001));
  ASSERT_TRUE(fine);
  ASSERT_EQ(fine->values.size(), 10001U);
  for (std::size_t i = 0; i < coarse.values.size(); ++i) ASSERT_EQ(fine->values[5 * i], coarse.values[i]);
}

TEST(Resample, ASineAtATenthOfTheRateKeepsItsAmplitudeWithinHalfAPercent) {
  // Half way between samples the weights are -1/16, 9/16, 9/16, -1/16, so the gain is 9/8 cos(w/2) - 1/8 cos(3w/2).
  constexpr double angle = 0.2 * std::numbers::pi;
  const double gain = 1.125 * std::cos(0.5 * angle) - 0.125 * std::cos(1.5 * angle);
  ASSERT_GT(gain, 0.995);
  const auto fine = resample(sampled(1.0, 200, [&](double t) { return std::sin(angle * t); }), Seconds(0.5));
  ASSERT_TRUE(fine);
  for (std::size_t i = 11; i < 380; i += 2) {
    EXPECT_NEAR(fine->values[i], gain * std::sin(0.5 * angle * static_cast<double>(i)), 1e-12);
  }
}

TEST(Resample, AStepOvershootsByLessThanEightPercent) {
  const auto fine = resample(sampled(1.0, 40, [](double t) { return t < 20.0 ? 0.0 : 1.0; }), Seconds(0.01));
  ASSERT_TRUE(fine);
  const auto [lowest, highest] = std::minmax_element(fine->values.begin(), fine->values.end());
  EXPECT_GT(*highest, 1.07);
  EXPECT_LT(*highest, 1.08);
  EXPECT_NEAR(*lowest, 1.0 - *highest, 1e-9);
}

TEST(Resample, ItEndsAtTheLastSampleAndNeverBeyond) {
  const auto line = [](double t) { return 7.0 * t; };
  for (const std::size_t samples : {2U, 3U, 10U, 9999U}) {
    for (const double target : {0.0002, 0.0003, 0.000499, 0.00005}) {
      const auto fine = resample(sampled(0.0005, samples, line), Seconds(target));
      ASSERT_TRUE(fine);
      const double end = 0.0005 * static_cast<double>(samples - 1);
      const double last = target * static_cast<double>(fine->values.size() - 1);
      EXPECT_LE(last, end * (1.0 + 1e-9));
      EXPECT_GT(last + target, end * (1.0 + 1e-9));
      EXPECT_LT(greatest_error(*fine, line), 1e-9);
    }
  }
}

TEST(Resample, AnEqualSampleTimeLeavesEveryValueUntouched) {
  const Signal signal = sampled(0.0005, 100, [](double t) { return std::exp(t); });
  const auto same = resample(signal, Seconds(0.0005 * (1.0 + 1e-9)));
  ASSERT_TRUE(same);
  EXPECT_EQ(same->values, signal.values);
}

TEST(Resample, ASlowerRateIsRefusedBecauseItWouldFoldFastContentIntoSlow) {
  const auto slow = resample(sampled(0.0001, 100, [](double t) { return t; }), Seconds(0.0002));
  ASSERT_FALSE(slow);
  EXPECT_EQ(slow.error().code, ErrorCode::inconsistent);
  EXPECT_TRUE(says(slow.error().message, "low-pass filter and decimate the recording first"));
}

TEST(Resample, WhatHasNoSampleTimeOrNoneThatCanBeIsRefused) {
  Signal signal = sampled(0.0005, 100, [](double t) { return t; });
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) EXPECT_FALSE(resample(signal, Seconds(bad)));
  EXPECT_TRUE(says(resample(signal, Seconds(1e-14)).error().message, "1e8 samples"));
  signal.sample_time_s.reset();
  EXPECT_TRUE(says(resample(signal, Seconds(0.0002)).error().message, "state sample_time_s"));
}

}  // namespace
}  // namespace tactus::recording
