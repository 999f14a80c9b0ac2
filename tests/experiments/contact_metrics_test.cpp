// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/contact_metrics.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::experiments {
namespace contact_metrics_test {

constexpr double tick_s = 2e-4;
constexpr std::size_t ticks_before = 1000;
constexpr std::size_t ticks_in_window = 1750;  // 0.35 s
constexpr double window_s = 0.35;

/// Nothing, then from the first touch on `force` of the time since it.
std::vector<double> contact(const std::function<double(double)>& force) {
  std::vector<double> values(ticks_before, 0.0);
  for (std::size_t i = 0; i < ticks_in_window; ++i) values.push_back(force(static_cast<double>(i) * tick_s));
  return values;
}

double sine(double frequency_Hz, double time_s) { return std::sin(2.0 * std::numbers::pi * frequency_Hz * time_s); }

TEST(ContactMetrics, AgreeWithSciPyOnTransientsThatSettleAndThatDoNot) {
  const OracleTable oracle("experiments_contact");
  const auto column = [&](const char* name) { return oracle.column(name); };
  const auto push_N = column("push_N"), amplitude_N = column("amplitude_N"), decay_s = column("decay_s");
  const auto frequency_Hz = column("frequency_Hz"), settled = column("settled");
  const auto settling_time_s = column("settling_time_s"), residual_rms_N = column("residual_rms_N");
  for (std::size_t i = 0; i < push_N.size(); ++i) {
    const auto force = contact([&](double t) {
      return push_N[i] +
             amplitude_N[i] * std::exp(-t / decay_s[i]) * std::cos(2.0 * std::numbers::pi * frequency_Hz[i] * t);
    });
    const ContactMetrics metrics = judge_contact(force, ticks_before, tick_s);
    EXPECT_EQ(metrics.settled, settled[i] == 1.0) << i;
    EXPECT_NEAR(metrics.settling_time_s, settling_time_s[i], 1e-9) << i;
    EXPECT_NEAR(metrics.residual_rms_N, residual_rms_N[i], 1e-9) << i;
  }
}

TEST(ContactMetrics, AFastTransientSettlesWhenItsEnvelopeHasFallenToATenth) {
  // Far above 15 Hz the filter changes next to nothing, so the last peak above a tenth lies within half a period, here
  // 1 ms, before decay time × ln 10.
  for (const double decay_s : {0.01, 0.02, 0.05}) {
    const auto force =
        contact([&](double t) { return std::exp(-t / decay_s) * std::cos(1000.0 * std::numbers::pi * t); });
    const ContactMetrics metrics = judge_contact(force, ticks_before, tick_s);
    EXPECT_TRUE(metrics.settled);
    EXPECT_LE(metrics.settling_time_s, decay_s * std::numbers::ln10 + tick_s);
    EXPECT_GE(metrics.settling_time_s, decay_s * std::numbers::ln10 - 0.0015);
  }
}

TEST(ContactMetrics, AVibrationThatStaysIsCensoredAtTheWindowAndItsResidualIsTheSinesBehindTheHighPass) {
  constexpr double amplitude_N = 0.8, frequency_Hz = 50.0;  // whole periods in the last 100 ms
  const auto force = contact([](double t) { return 0.5 + amplitude_N * sine(frequency_Hz, t); });
  const ContactMetrics metrics = judge_contact(force, ticks_before, tick_s);
  EXPECT_FALSE(metrics.settled);
  EXPECT_NEAR(metrics.settling_time_s, window_s, 1e-12);
  // |H| of a second-order Butterworth high-pass behind the bilinear transform: 1 / sqrt(1 + (f_c / f)^4), warped.
  const double ratio = std::tan(std::numbers::pi * 15.0 * tick_s) / std::tan(std::numbers::pi * frequency_Hz * tick_s);
  const double gain = 1.0 / std::sqrt(1.0 + std::pow(ratio, 4));
  EXPECT_NEAR(metrics.residual_rms_N, gain * amplitude_N / std::numbers::sqrt2, 1e-6);
}

TEST(ContactMetrics, ATransientMustBeSmallForFiftyMillisecondsToCountAsSettled) {
  // Whole periods of a fast sine, so that it ends without a step for the high-pass to ring with.
  const auto burst_until = [](double end_s) {
    return contact([end_s](double t) { return t < end_s ? sine(500.0, t) : 0.0; });
  };
  const ContactMetrics early = judge_contact(burst_until(0.296), ticks_before, tick_s);
  EXPECT_TRUE(early.settled);
  EXPECT_NEAR(early.settling_time_s, 0.296, 0.001);
  const ContactMetrics late = judge_contact(burst_until(0.304), ticks_before, tick_s);
  EXPECT_FALSE(late.settled);
  EXPECT_NEAR(late.settling_time_s, window_s, 1e-12);
}

TEST(ContactMetrics, OneLateKnockIsEnoughNotToSettle) {
  const auto force = contact([](double t) { return t < 0.01 || (t > 0.33 && t < 0.332) ? sine(500.0, t) : 0.0; });
  EXPECT_FALSE(judge_contact(force, ticks_before, tick_s).settled);
}

TEST(ContactMetrics, WhatWasBeforeTheFirstTouchSetsNoThreshold) {
  const auto force = contact([](double t) { return std::exp(-t / 0.02) * sine(200.0, t); });
  std::vector<double> with_knock(5000, 0.0);
  with_knock[0] = 50.0;
  with_knock.insert(with_knock.end(), force.begin(), force.end());
  const ContactMetrics alone = judge_contact(force, ticks_before, tick_s);
  const ContactMetrics after_knock = judge_contact(with_knock, 5000 + ticks_before, tick_s);
  EXPECT_EQ(after_knock.settling_time_s, alone.settling_time_s);
  EXPECT_NEAR(after_knock.residual_rms_N, alone.residual_rms_N, 1e-9);
}

TEST(ContactMetrics, AWindowThatWasCutShortIsJudgedWithoutReadingBeyondIt) {
  const std::vector<double> force{0.0, 0.0, 0.5, 1.0};
  const ContactMetrics metrics = judge_contact(force, 2, tick_s);
  EXPECT_FALSE(metrics.settled);
  EXPECT_NEAR(metrics.settling_time_s, 2.0 * tick_s, 1e-12);
  // So short after the touch the high-pass has hardly begun to forget.
  EXPECT_NEAR(metrics.residual_rms_N, std::sqrt((0.25 + 1.0) / 2.0), 0.02);
}

}  // namespace contact_metrics_test
}  // namespace tactus::experiments
