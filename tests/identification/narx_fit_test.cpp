// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/narx_fit.hpp>
#include <tactus/identification/axis/orthogonal_least_squares.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::identification {
namespace narx_fit_test {

using control::NarxForceEstimator;
using control::SlaveMotionSample;

TEST(OrthogonalLeastSquares, RanksAsRefittingEveryCandidateDoes) {
  const OracleTable data("identification_orthogonal_least_squares_data");
  const OracleTable ranks("identification_orthogonal_least_squares_ranks");
  constexpr std::size_t columns = 8;
  const auto y = data.column("y");
  std::vector<double> regressors(y.size() * columns);
  for (std::size_t column = 0; column < columns; ++column) {
    const auto values = data.column("a_" + std::to_string(column));
    for (std::size_t row = 0; row < y.size(); ++row) regressors[row * columns + column] = values[row];
  }
  const auto ranked = rank_regressors(regressors, columns, y, columns);
  ASSERT_TRUE(ranked);
  ASSERT_EQ(ranked->size(), ranks.column("column").size());
  for (std::size_t i = 0; i < ranked->size(); ++i) {
    EXPECT_EQ((*ranked)[i].column, ranks.column<std::size_t>("column")[i]);
    EXPECT_NEAR((*ranked)[i].error_reduction, ranks.column("error_reduction")[i], 1e-11);
  }
}

TEST(OrthogonalLeastSquares, NeverTakesAColumnThatAddsNothing) {
  // The third column is the sum of the others.
  const std::vector<double> regressors{1, 0, 1, 0, 1, 1, 2, 1, 3, 1, 3, 4, 5, 1, 6, 2, 2, 4};
  std::vector<double> y;
  for (std::size_t row = 0; row < 6; ++row) y.push_back(2.0 * regressors[3 * row] - 7.0 * regressors[3 * row + 1]);
  const auto ranked = rank_regressors(regressors, 3, y, 3);
  ASSERT_TRUE(ranked);
  EXPECT_EQ(ranked->size(), 2U);
}

TEST(OrthogonalLeastSquares, RefusesWhatHoldsNothingToFit) {
  EXPECT_EQ(rank_regressors(std::vector<double>{1, 2}, 1, std::vector<double>{0, 0}, 1).error().code,
            ErrorCode::inconsistent);
  EXPECT_EQ(rank_regressors(std::vector<double>{1, 2, 3}, 1, std::vector<double>{1, 2}, 1).error().code,
            ErrorCode::inconsistent);
  EXPECT_EQ(rank_regressors(std::vector<double>{1, NAN}, 1, std::vector<double>{1, 2}, 1).error().code,
            ErrorCode::out_of_bounds);
}

constexpr Seconds dt{1e-3};
constexpr double lag_s = 0.004;

/// A Butterworth low-pass of second order by RK4 on its differential equation, not the element under test.
std::vector<double> low_passed(const std::vector<double>& signal, double cutoff_Hz) {
  const double omega = 2.0 * std::numbers::pi * cutoff_Hz;
  std::vector<double> result;
  double y = 0.0, v = 0.0;
  constexpr int parts = 20;
  for (std::size_t tick = 0; tick < signal.size(); ++tick) {
    result.push_back(y);
    const double from = signal[tick], to = tick + 1 < signal.size() ? signal[tick + 1] : from;
    for (int i = 0; i < parts; ++i) {
      const double h = dt.value / parts, u = from + (to - from) * (i + 0.5) / parts;
      const auto rate = [&](double at, double speed) {
        return omega * omega * (u - at) - std::numbers::sqrt2 * omega * speed;
      };
      const double middle = v + 0.5 * h * rate(y, v), middle_y = y + 0.5 * h * v;
      v += h * rate(middle_y, middle);
      y += h * middle;
    }
  }
  return result;
}

std::vector<double> random_path(double seconds, std::uint64_t seed) {
  signal::Random random(seed);
  std::vector<double> white;
  for (double t = 0.0; t < seconds; t += dt.value) white.push_back(0.02 * random.normal());
  return low_passed(white, 10.0);
}

/// What acts on a slave whose force is a polynomial of two differences of its position: linear and cubic.
double polynomial_force(double newer_m, double older_m) {
  return 300.0 * newer_m - 120.0 * older_m + 8e6 * newer_m * newer_m * newer_m;
}

/// So slow that the fit's own low-pass, at 400 Hz, only delays force and position alike.
std::vector<SlaveMotionSample> polynomial_motion(double seconds, std::uint64_t seed) {
  const std::vector<double> x = random_path(seconds, seed);
  constexpr std::size_t lag = 4;
  std::vector<SlaveMotionSample> motion;
  for (std::size_t k = 2 * lag; k < x.size(); ++k) {
    motion.push_back(
        {.command = 0.5 * polynomial_force(x[k] - x[k - lag], x[k - lag] - x[k - 2 * lag]), .position = x[k]});
  }
  return motion;
}

NarxStructure structure() { return {.differences = 4, .lag_s = lag_s, .cutoff_Hz = 400.0, .actuator_gain = 2.0}; }

TEST(NarxFit, FindsTheTermsOfAKnownPolynomialAndItsCoefficients) {
  const auto fit = fit_narx(polynomial_motion(20.0, 3), structure(), dt);
  ASSERT_TRUE(fit) << describe(fit.error());
  const double scale_m = fit->model.scales.difference_scale_m;
  const auto coefficient = [&fit](std::int64_t v1, std::int64_t v2, std::int64_t v3) {
    for (const RankedNarxTerm& ranked : fit->terms) {
      const auto& t = ranked.term;
      if (t.variable_1 == v1 && t.variable_2 == v2 && t.variable_3 == v3) return t.coefficient_N;
    }
    return 0.0;
  };
  EXPECT_NEAR(coefficient(1, 0, 0), 300.0 * scale_m, 0.02 * 300.0 * scale_m);
  EXPECT_NEAR(coefficient(2, 0, 0), -120.0 * scale_m, 0.02 * 300.0 * scale_m);
  EXPECT_NEAR(coefficient(1, 1, 1), 8e6 * std::pow(scale_m, 3), 0.02 * 8e6 * std::pow(scale_m, 3));
  EXPECT_LT(fit->residual_rms_N, 0.01 * fit->command_rms_N);
  EXPECT_LE(std::accumulate(fit->terms.begin(), fit->terms.end(), 0.0,
                            [](double sum, const RankedNarxTerm& t) { return sum + t.error_reduction; }),
            1.0);
}

TEST(NarxForceEstimator, OfTheFittedModelFeelsNothingOnAnotherFreeMotionAndAPushWithItsSign) {
  const auto fit = fit_narx(polynomial_motion(20.0, 3), structure(), dt);
  ASSERT_TRUE(fit) << describe(fit.error());
  auto estimator = NarxForceEstimator::make(fit->model, dt).value();
  double squares = 0.0, commands = 0.0;
  const auto other = polynomial_motion(5.0, 4);
  for (const SlaveMotionSample& sample : other) {
    squares += std::pow(estimator.step(sample).force, 2);
    commands += std::pow(2.0 * sample.command, 2);
  }
  EXPECT_LT(squares, 1e-3 * commands);
  // A wall pushes back with 0.3 N: the actuator of gain 2 needs 0.15 more for the same motion.
  double force_N = 0.0;
  estimator.reset();
  for (SlaveMotionSample sample : other) {
    sample.command += 0.15;
    force_N += estimator.step(sample).force / static_cast<double>(other.size());
  }
  EXPECT_NEAR(force_N, -0.3, 0.01);
}

TEST(NarxForceEstimator, ARecursionThatRunsAwayStopsAtItsLimit) {
  NarxForceEstimator::Params params;
  params.scales.force_limit_N = 3.0;
  params.terms.term_0 = {.coefficient_N = 0.1, .variable_1 = 1};
  params.terms.term_1 = {.coefficient_N = 4.0, .variable_1 = 7};
  auto estimator = NarxForceEstimator::make(params, dt).value();
  double force = 0.0;
  for (int tick = 0; tick < 500; ++tick) force = estimator.step({.command = 0.0, .position = 1e-3 * tick}).force;
  EXPECT_EQ(force, 3.0);
}

TEST(NarxFit, SaysWhenTheDataAreTooPoor) {
  const auto message = [](const std::vector<SlaveMotionSample>& motion, const NarxStructure& s) {
    const auto fit = fit_narx(motion, s, dt);
    return fit ? std::string("fitted") : fit.error().parameter + ": " + fit.error().message;
  };
  const auto motion = polynomial_motion(2.0, 3);
  EXPECT_NE(message({motion.begin(), motion.begin() + 300}, structure()).find("too few to choose among 35 terms"),
            std::string::npos);
  EXPECT_NE(message({}, structure()).find("0 rows"), std::string::npos);
  EXPECT_NE(message(std::vector<SlaveMotionSample>(5000), structure()).find("no force or does not move"),
            std::string::npos);
  // Force that has nothing to do with the motion.
  signal::Random random(7);
  auto unrelated = polynomial_motion(20.0, 3);
  for (SlaveMotionSample& sample : unrelated) sample.command = random.normal();
  EXPECT_NE(message(unrelated, structure()).find("no term explains the force"), std::string::npos);
  auto broken = polynomial_motion(20.0, 3);
  broken[100].position = NAN;
  EXPECT_NE(message(broken, structure()).find("not a finite number"), std::string::npos);
}

TEST(NarxFit, RefusesAModelThatOnlyRepeatsItsOutput) {
  // A slow force that no difference of positions tells, but the force one lag before does.
  auto motion = polynomial_motion(20.0, 3);
  const std::vector<double> slow = random_path(21.0, 9);
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i].command = 100.0 * slow[i];
  NarxStructure with_outputs = structure();
  with_outputs.output_lags = 1;
  with_outputs.degree = 1;
  const auto fit = fit_narx(motion, with_outputs, dt);
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().parameter, "output_lags");
}

TEST(NarxFit, NamesTheKeyThatIsOutOfBounds) {
  NarxStructure wrong = structure();
  wrong.degree = 4;
  EXPECT_EQ(fit_narx({}, wrong, dt).error().parameter, "degree");
  wrong = structure();
  wrong.lag_s = 0.1;
  EXPECT_EQ(fit_narx({}, wrong, dt).error().parameter, "lag_s");
  wrong = structure();
  wrong.cutoff_Hz = 500.0;
  EXPECT_EQ(fit_narx({}, wrong, dt).error().parameter, "cutoff_Hz");
}

}  // namespace narx_fit_test
}  // namespace tactus::identification
