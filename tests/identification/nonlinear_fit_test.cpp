// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/nonlinear_fit.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace nonlinear_fit_test {

constexpr int samples = 400;
double time_of(int i) { return 0.01 * i; }

/// Residuals of y = exp(a) · exp(−exp(b) t) against samples of it.
NonlinearProblem decay(const std::vector<double>& measured) {
  NonlinearProblem problem;
  problem.start = {std::log(1.0), std::log(1.0)};
  problem.residuals = [measured](std::span<const double> v) {
    std::vector<double> left;
    for (int i = 0; i < samples; ++i) {
      left.push_back(measured[static_cast<std::size_t>(i)] - std::exp(v[0] - std::exp(v[1]) * time_of(i)));
    }
    return left;
  };
  return problem;
}

std::vector<double> noisy_decay(double rms, std::uint64_t seed) {
  signal::Random random(seed);
  std::vector<double> measured;
  for (int i = 0; i < samples; ++i) measured.push_back(2.5 * std::exp(-1.7 * time_of(i)) + rms * random.normal());
  return measured;
}

TEST(NonlinearFit, ExactDataGiveTheExactParameters) {
  const auto fit = fit_nonlinear(decay(noisy_decay(0.0, 1)));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(std::exp(fit->found[0]), 2.5, 1e-6);
  EXPECT_NEAR(std::exp(fit->found[1]), 1.7, 1e-6);
  EXPECT_LT(fit->residual_rms, 1e-6);
}

TEST(NonlinearFit, TheStatedDeviationIsTheScatterOfRepeatedMeasurements) {
  constexpr int runs = 300;
  double squares = 0.0, stated = 0.0;
  for (int run = 0; run < runs; ++run) {
    const auto fit = fit_nonlinear(decay(noisy_decay(0.05, static_cast<std::uint64_t>(run + 10))));
    ASSERT_TRUE(fit);
    squares += std::pow(fit->found[1] - std::log(1.7), 2);
    stated += fit->own_deviation[1] * fit->own_deviation[1];
  }
  EXPECT_NEAR(std::sqrt(stated / squares), 1.0, 0.15);
}

TEST(NonlinearFit, APriorAndDataMeetWhereTheirPrecisionsSay) {
  // One variable, measured four times with deviation 1 about 3, known before to be 1 ± 0.5: precisions 4 and 4.
  NonlinearProblem problem;
  problem.start = {0.0};
  problem.prior_middle = {1.0};
  problem.prior_deviation = {0.5};
  problem.residuals = [](std::span<const double> v) {
    return std::vector<double>{2.0 - v[0], 4.0 - v[0], 2.0 - v[0], 4.0 - v[0]};
  };
  const auto fit = fit_nonlinear(problem);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->found[0], 2.0, 1e-6);
}

TEST(NonlinearFit, AVariableOfWhichTheDataTellNothingStaysAsUncertainAsItWas) {
  NonlinearProblem problem = decay(noisy_decay(0.05, 3));
  problem.start.push_back(0.7);
  problem.prior_middle = {0.0, 0.0, 0.7};
  problem.prior_deviation = {0.0, 0.0, 0.3};
  const auto fit = fit_nonlinear(problem);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->found[2], 0.7, 1e-9);
  EXPECT_NEAR(fit->own_deviation[2], 0.3, 1e-9);
  const auto alone = fit_nonlinear(decay(noisy_decay(0.05, 3)));
  // The search ends where steps get smaller than a millionth.
  EXPECT_NEAR(fit->found[1], alone->found[1], 1e-5);
}

/// A straight line y = p + q x whose slope is given.
NonlinearProblem line_of_given_slope() {
  NonlinearProblem problem;
  problem.start = {0.0, 3.0};
  problem.given = 1;
  problem.given_covariance = {0.04};
  problem.residuals = [](std::span<const double> v) {
    std::vector<double> left;
    for (int i = 0; i < samples; ++i) left.push_back(1.0 + 3.0 * time_of(i) - v[0] - v[1] * time_of(i));
    return left;
  };
  return problem;
}

TEST(NonlinearFit, WhatIsGivenPassesOnWhatItDoesNotKnow) {
  const auto fit = fit_nonlinear(line_of_given_slope());
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->found[0], 1.0, 1e-9);
  // A slope that is off by d moves the offset by −d times the mean of x: variance 0.04·x̄², covariance −0.04·x̄.
  const double mean = 0.01 * (samples - 1) / 2.0;
  EXPECT_NEAR(fit->covariance[0], 0.04 * mean * mean, 1e-6);
  EXPECT_NEAR(fit->covariance[1], -0.04 * mean, 1e-6);
  EXPECT_NEAR(fit->covariance[3], 0.04, 1e-12);
}

TEST(NonlinearFit, AVariableThatChangesNothingIsNamed) {
  NonlinearProblem problem = line_of_given_slope();
  problem.start = {0.0, 0.0, 3.0};
  problem.residuals = [](std::span<const double> v) {
    std::vector<double> left;
    for (int i = 0; i < samples; ++i) left.push_back(1.0 - v[0] + 0.0 * v[1]);
    return left;
  };
  const auto fit = fit_nonlinear(problem);
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::inconsistent);
  EXPECT_EQ(fit.error().parameter, "1");
}

TEST(NonlinearFit, AStepThatIsNoModelIsTakenBackAndTheFitGoesOn) {
  NonlinearProblem problem;
  problem.start = {0.9};
  bool beyond = false;
  problem.residuals = [&beyond](std::span<const double> v) {
    beyond = beyond || v[0] <= 0.0;  // where there is no logarithm
    return std::vector<double>(samples, std::log(v[0] / 0.1));
  };
  const auto fit = fit_nonlinear(problem);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(beyond);
  EXPECT_NEAR(fit->found[0], 0.1, 1e-4);
}

TEST(NonlinearFit, AStartThatIsNoModelAndTooFewResidualsAreRefused) {
  NonlinearProblem problem = line_of_given_slope();
  problem.residuals = [](std::span<const double>) {
    return std::vector<double>(samples, std::numeric_limits<double>::quiet_NaN());
  };
  EXPECT_FALSE(fit_nonlinear(problem));
  problem.residuals = [](std::span<const double>) { return std::vector<double>{0.0}; };
  EXPECT_FALSE(fit_nonlinear(problem));
}

}  // namespace nonlinear_fit_test
}  // namespace tactus::identification
