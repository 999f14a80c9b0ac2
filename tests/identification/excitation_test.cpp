// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/excitation.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace excitation_test {

using Samples = std::vector<double>;

constexpr Seconds tick{2e-4};
constexpr double pi = std::numbers::pi;

double peak(const Samples& samples) {
  double largest = 0.0;
  for (const double sample : samples) largest = std::max(largest, std::abs(sample));
  return largest;
}

/// Frequency around an instant from two rising zero crossings, each interpolated.
double frequency_Hz(const Samples& samples, double at_s) {
  double first_s = -1.0;
  for (auto i = static_cast<std::size_t>(at_s / tick.value); i + 1 < samples.size(); ++i) {
    if (samples[i] > 0.0 || samples[i + 1] <= 0.0) continue;
    const double crossing_s = tick.value * (static_cast<double>(i) + samples[i] / (samples[i] - samples[i + 1]));
    if (first_s >= 0.0) return 1.0 / (crossing_s - first_s);
    first_s = crossing_s;
  }
  return 0.0;
}

TEST(SweptSine, has_the_frequency_that_its_spacing_says_at_every_time) {
  for (const double part : {0.1, 0.3, 0.5, 0.7}) {
    const double time_s = 20.0 * part;
    const auto logarithmic = swept_sine_N({.start_Hz = 200.0, .end_Hz = 5.0}, tick);
    EXPECT_NEAR(frequency_Hz(*logarithmic, time_s) / (200.0 * std::pow(5.0 / 200.0, part)), 1.0, 0.02);
    const auto linear = swept_sine_N({.start_Hz = 200.0, .end_Hz = 5.0, .spacing = SweepSpacing::linear}, tick);
    EXPECT_NEAR(frequency_Hz(*linear, time_s) / (200.0 - 195.0 * part), 1.0, 0.02);
  }
}

TEST(Multisine, repeats_exactly_holds_its_lines_alone_equally_high_and_has_a_low_crest) {
  const MultisineParams params{.lowest_Hz = 3.0, .highest_Hz = 60.0, .period_s = 1.0, .periods = 2, .peak_N = 2.0};
  const auto force_N = multisine_N(params, tick);
  ASSERT_TRUE(force_N);
  ASSERT_EQ(force_N->size(), 4U * 5000U);
  double squares = 0.0;
  for (std::size_t i = 5000; i < 10'000; ++i) {
    EXPECT_EQ((*force_N)[i], (*force_N)[i + 5000]);
    squares += (*force_N)[i] * (*force_N)[i];
  }
  EXPECT_NEAR(peak(*force_N), 2.0, 1e-12);
  EXPECT_LT(2.0 / std::sqrt(squares / 5000.0), 2.0);  // aligned phases would give the root of 2·58 lines: 10.8
  double on_line = 0.0;
  for (const int line : {2, 3, 30, 60, 61}) {
    std::complex<double> sum{};
    for (std::size_t i = 0; i < 5000; ++i) {
      sum += (*force_N)[5000 + i] * std::polar(1.0, -2.0 * pi * line * static_cast<double>(i) / 5000.0);
    }
    if (line == 3) on_line = std::abs(sum);
    EXPECT_NEAR(std::abs(sum), line == 2 || line == 61 ? 0.0 : on_line, 1e-8) << line;
  }
}

TEST(RandomBinary, holds_either_force_and_is_the_same_for_the_same_seed_alone) {
  const auto one = random_binary_N({.hold_s = 1e-3, .seed = 3}, tick);
  EXPECT_EQ(*one, *random_binary_N({.hold_s = 1e-3, .seed = 3}, tick));
  EXPECT_NE(*one, *random_binary_N({.hold_s = 1e-3, .seed = 4}, tick));
  double sum = 0.0;
  for (std::size_t i = 1000; i < 99'000; ++i) {
    EXPECT_EQ(std::abs((*one)[i]), 1.0);
    if (i % 5 != 0) {
      EXPECT_EQ((*one)[i], (*one)[i - 1]);
    }
    sum += (*one)[i];
  }
  EXPECT_LT(std::abs(sum / 98'000.0), 4.0 / std::sqrt(19'600.0));  // four standard errors of as many draws
}

TEST(ForceLoops, climb_at_the_stated_rate_turn_at_the_peak_and_close) {
  const auto force_N = force_loops_N({.peak_N = 2.0, .rate_N_per_s = 4.0, .loops = 2}, tick);
  ASSERT_EQ(force_N->size(), 20'001U);  // 2 loops of 4·2/4 s
  EXPECT_NEAR((*force_N)[2500], 2.0, 1e-12);
  EXPECT_NEAR((*force_N)[7500], -2.0, 1e-12);
  for (std::size_t i = 1; i < force_N->size(); ++i) {
    EXPECT_NEAR(std::abs((*force_N)[i] - (*force_N)[i - 1]), 4.0 * tick.value, 1e-9);
  }
}

TEST(Crossing, runs_there_and_back_at_its_speed_within_the_workspace_without_a_jump_in_speed) {
  const CrossingParams params{};
  const auto position_m = crossing_m(params, tick);
  ASSERT_TRUE(position_m);
  EXPECT_EQ(position_m->front(), params.from_m);
  EXPECT_NEAR(position_m->back(), params.from_m, 1e-12);
  EXPECT_NEAR(*std::max_element(position_m->begin(), position_m->end()), params.to_m, 1e-9);
  EXPECT_NEAR((*position_m)[5001] - (*position_m)[5000], params.speed_m_per_s * tick.value, 1e-12);
  const double steepest = params.speed_m_per_s * pi / (2.0 * params.fade_s);  // slope of the half cosine
  for (std::size_t i = 1; i + 1 < position_m->size(); ++i) {
    const double change = (*position_m)[i + 1] - 2.0 * (*position_m)[i] + (*position_m)[i - 1];
    EXPECT_LE(std::abs(change), 1.001 * steepest * tick.value * tick.value);
  }
}

TEST(Excitation, forces_begin_and_end_at_rest_and_never_exceed_the_limit) {
  const ForceEnvelope envelope{.force_limit_N = 1.0, .fade_s = 0.5};
  for (const auto& force_N :
       {swept_sine_N({.envelope = envelope}, tick), multisine_N({.envelope = envelope}, tick),
        random_binary_N({.envelope = envelope}, tick), force_loops_N({.peak_N = 1.0, .force_limit_N = 1.0}, tick)}) {
    ASSERT_TRUE(force_N);
    EXPECT_EQ(force_N->front(), 0.0);
    EXPECT_EQ(force_N->back(), 0.0);
    EXPECT_LE(peak(*force_N), 1.0);
    for (std::size_t i = 0; i < 50; ++i) {  // 10 ms into a fade of half a second: (1 − cos(π/50))/2 = 0.001
      EXPECT_LE(std::abs((*force_N)[i]), 0.0105);
    }
  }
}

TEST(Excitation, what_would_exceed_a_limit_or_cannot_be_is_refused) {
  EXPECT_FALSE(swept_sine_N({.amplitude_N = 6.0}, tick));
  EXPECT_FALSE(swept_sine_N({.start_Hz = 2500.0}, tick));
  EXPECT_FALSE(swept_sine_N({.duration_s = 0.1}, tick));
  EXPECT_FALSE(swept_sine_N({.duration_s = 3600.0}, Seconds{1e-9}));
  EXPECT_FALSE(multisine_N({.peak_N = 6.0}, tick));
  EXPECT_FALSE(multisine_N({.lowest_Hz = 10.2, .highest_Hz = 10.7}, tick));
  EXPECT_FALSE(random_binary_N({.amplitude_N = 6.0}, tick));
  EXPECT_FALSE(random_binary_N({}, Seconds{0.0}));
  EXPECT_FALSE(force_loops_N({.peak_N = 6.0}, tick));
  EXPECT_FALSE(force_loops_N({.rate_N_per_s = 1e-9}, tick));
  EXPECT_FALSE(crossing_m({.to_m = 0.04}, tick));
  EXPECT_FALSE(crossing_m({.fade_s = 3.0}, tick));
}

}  // namespace excitation_test
}  // namespace tactus::identification
