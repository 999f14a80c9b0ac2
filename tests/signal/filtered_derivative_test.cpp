// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <cmath>
#include <numbers>

#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

namespace tactus::signal {
namespace filtered_derivative_test {

static_assert(Element<FilteredDerivative>);

constexpr double dt_s = 200e-6;

FilteredDerivative derivative(double cutoff_Hz) {
  return FilteredDerivative::make({.cutoff_Hz = cutoff_Hz}, Seconds{dt_s}).value();
}

/// The first sample only initialises, so the impulse must not be the first sample.
struct Started {
  explicit Started(double cutoff_Hz) : element(derivative(cutoff_Hz)) {}
  void reset() {
    element.reset();
    element.step(0.0);
  }
  double step(double position) { return element.step(position); }
  FilteredDerivative element;
};

TEST(FilteredDerivative, IsThreeDecibelsBelowTheIdealDifferentiatorExactlyAtItsCutoff) {
  for (const double cutoff_Hz : {5.0, 30.0, 300.0, 1000.0, 2000.0, 2190.0}) {
    const double ideal_per_s = 2.0 * std::numbers::pi * cutoff_Hz;
    EXPECT_NEAR(std::abs(measured_response(Started(cutoff_Hz), cutoff_Hz, dt_s)) / ideal_per_s,
                std::numbers::sqrt2 / 2.0, 1e-9)
        << cutoff_Hz;
  }
}

TEST(FilteredDerivative, DifferentiatesSlowMotionLikeTheIdeal) {
  const auto response = measured_response(Started(300.0), 1.0, dt_s);
  EXPECT_NEAR(std::abs(response) / (2.0 * std::numbers::pi), 1.0, 1e-4);
  EXPECT_NEAR(std::arg(response), std::numbers::pi / 2.0, 0.01);
}

TEST(FilteredDerivative, GivesTheExactSlopeOfARamp) {
  auto element = derivative(300.0);
  double velocity = 0.0;
  for (int n = 0; n < 500; ++n) velocity = element.step(3.0 + 0.15 * dt_s * n);
  EXPECT_NEAR(velocity, 0.15, 1e-10);
}

TEST(FilteredDerivative, AGapGivesWhatAsManySamplesOnAStraightLineWouldHaveGiven) {
  auto gapped = derivative(300.0), sampled = gapped, each = gapped;
  for (double position : {0.0, 0.01, 0.03, 0.02}) {
    gapped.step(position);
    sampled.step(position);
  }
  double velocity = 0.0;
  for (int n = 1; n <= 7; ++n) velocity = sampled.step(0.02 + 0.005 * n);
  EXPECT_NEAR(gapped.step(0.055, 7), velocity, 1e-9 * velocity);
  EXPECT_NEAR(gapped.step(0.056), sampled.step(0.056), 1e-9 * velocity);
  EXPECT_EQ(each.step(12.5, 7), 0.0) << "the first sample only initialises";
}

TEST(FilteredDerivative, TheSlopeOfARampIsExactHoweverUnevenlyItIsSampled) {
  auto element = derivative(300.0);
  double at_s = 0.0, velocity = 0.0;
  element.step(0.0);
  for (int n = 0; n < 500; ++n) {
    const double samples = n % 3 == 0 ? 0.4 : n % 3 == 1 ? 1.0 : 2.7;
    at_s += samples * dt_s;
    velocity = element.step_after(0.15 * at_s, samples);
  }
  EXPECT_NEAR(velocity, 0.15, 1e-10);
}

TEST(FilteredDerivative, StartsWithoutAKickFarFromZeroAndAgainAfterAReset) {
  auto element = derivative(300.0);
  EXPECT_EQ(element.step(12.5), 0.0);
  EXPECT_EQ(element.step(12.5), 0.0);
  EXPECT_GT(element.step(12.6), 0.0);
  element.reset();
  EXPECT_EQ(element.step(-4.0), 0.0);
}

TEST(FilteredDerivative, ACutoffThatABackwardDifferenceCannotReachIsRefused) {
  const auto refused = FilteredDerivative::make({.cutoff_Hz = 2200.0}, Seconds{dt_s});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(describe(refused.error()),
            "cutoff_Hz: 2200 Hz must lie below 2200 Hz, 0.44 of the sample rate: lower the cutoff or sample faster");
}

}  // namespace filtered_derivative_test
}  // namespace tactus::signal
