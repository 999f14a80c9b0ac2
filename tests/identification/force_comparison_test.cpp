// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/force_comparison.hpp>
#include <tactus/identification/axis/zero_phase.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace force_comparison_test {

constexpr Seconds dt{1e-3};

std::vector<double> sine(double frequency_Hz, double lead_s, std::size_t count = 4000) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back(std::sin(2.0 * std::numbers::pi * frequency_Hz * (static_cast<double>(i) * dt.value + lead_s)));
  }
  return values;
}

TEST(ZeroPhase, a_sine_at_the_cutoff_keeps_its_phase_and_half_its_amplitude) {
  const auto input = sine(20.0, 0.0);
  const auto output = zero_phase_low_pass(input, 20.0, dt);
  ASSERT_TRUE(output);
  for (std::size_t i = 500; i < 3500; ++i) EXPECT_NEAR((*output)[i], 0.5 * input[i], 1e-6);
}

TEST(ZeroPhase, a_ramp_passes_without_transients_at_its_ends) {
  std::vector<double> ramp;
  for (int i = 0; i < 1000; ++i) ramp.push_back(3.0 + 0.01 * i);
  const auto output = zero_phase_low_pass(ramp, 20.0, dt);
  ASSERT_TRUE(output);
  for (std::size_t i = 0; i < ramp.size(); ++i) EXPECT_NEAR((*output)[i], ramp[i], 2e-3);
  const auto slope = central_difference(ramp, dt);
  EXPECT_NEAR(slope.front(), 10.0, 1e-9);
  EXPECT_NEAR(slope[500], 10.0, 1e-9);
}

TEST(ZeroPhase, a_cutoff_beyond_half_the_sample_rate_is_refused) {
  EXPECT_FALSE(zero_phase_low_pass(sine(1.0, 0.0), 600.0, dt));
  EXPECT_FALSE(zero_phase_low_pass(std::vector<double>{1.0}, 20.0, dt));
}

TEST(ForceComparison, an_estimate_that_leads_by_a_fraction_of_a_sample_is_told_so) {
  for (const double lead_s : {0.0, 0.0035, -0.0072}) {
    const auto comparison = compare_force(sine(2.0, lead_s), sine(2.0, 0.0), 60.0, dt, 100);
    ASSERT_TRUE(comparison);
    EXPECT_NEAR(comparison->lead_s, lead_s, 1e-4);
    // Correlation of two sines is the cosine of their phase, up to the skipped part of a period.
    EXPECT_NEAR(comparison->correlation, std::cos(2.0 * std::numbers::pi * 2.0 * lead_s), 1e-3);
  }
}

TEST(ForceComparison, an_offset_is_all_error_and_no_loss_of_correlation) {
  auto estimate = sine(2.0, 0.0);
  for (double& value : estimate) value += 0.25;
  const auto comparison = compare_force(estimate, sine(2.0, 0.0), 60.0, dt, 0);
  ASSERT_TRUE(comparison);
  EXPECT_NEAR(comparison->rmse, 0.25, 1e-4);
  EXPECT_NEAR(comparison->mean_error, 0.25, 1e-4);
  EXPECT_NEAR(comparison->correlation, 1.0, 1e-6);
}

TEST(FalseForce, IsTheEstimateWhereTheAxisMovesAndNothingIsMeasured) {
  // One second of free motion, one of contact, one at rest, at 1 kHz.
  std::vector<double> estimate(3000, 0.0);
  std::vector<double> reference(3000, 0.0);
  std::vector<double> position(3000, 0.0);
  for (std::size_t i = 0; i < 3000; ++i) {
    if (i < 2000) estimate[i] = i < 1000 ? 0.02 : 5.0;
    reference[i] = i >= 1000 && i < 2000 ? 1.0 : 0.0;
    position[i] = 0.001 * static_cast<double>(std::min<std::size_t>(i, 2000));
  }
  const auto felt = false_force(estimate, reference, position, 0.01, Seconds{1e-3}, 100);
  ASSERT_TRUE(felt);
  EXPECT_NEAR(felt->duration_s, 0.9, 0.02);
  // The filter smears the stop over a few samples, which count with an estimate of 0.
  EXPECT_NEAR(felt->rms, 0.02, 5e-4);
  EXPECT_EQ(false_force(estimate, std::vector<double>(3000, 1.0), position, 0.01, Seconds{1e-3}, 100)->duration_s, 0.0);
}

}  // namespace force_comparison_test
}  // namespace tactus::identification
