// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>

#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

namespace tactus::control {
namespace inverse_model_estimator_test {

using Params = InverseModelEstimator::Params;
constexpr Seconds dt{1e-4};

Params unpredicted() {
  Params params;
  params.prediction.blocks = 0;
  return params;
}

/// Largest estimate over the last of 5 periods when the position is a sine and the command what `command` says.
template <class Command>
double largest_estimate(const Params& params, double frequency_Hz, Command command) {
  InverseModelEstimator estimator = InverseModelEstimator::make(params, dt).value();
  const double omega = 2.0 * std::numbers::pi * frequency_Hz;
  double largest = 0.0;
  for (double t = 0.0; t < 5.0 / frequency_Hz; t += dt.value) {
    const double force = estimator.step({.command = command(t), .position = 0.1 * std::sin(omega * t)}).force;
    if (t > 4.0 / frequency_Hz) largest = std::max(largest, std::abs(force));
  }
  return largest;
}

TEST(InverseModelEstimator, AConstantPushAgainstAHeldSlaveIsFeltWithItsSign) {
  InverseModelEstimator estimator = InverseModelEstimator::make(Params{}, dt).value();
  double force = 0.0;
  for (int tick = 0; tick < 1000; ++tick) force = estimator.step({.command = 3.0, .position = 0.0}).force;
  EXPECT_NEAR(force, -3.0, 1e-9);  // the wall pushes back
}

TEST(InverseModelEstimator, FreeMotionLeavesWhatTheFiltersLag) {
  // x = a·sin(ωt), u = M·ẍ + h·ẋ without delay: only T_d separates the two, and |1/(1 + jωT_d) − 1| ≈ ω·T_d.
  const double omega = 2.0 * std::numbers::pi;
  const double amplitude_N = 0.1 * omega * std::hypot(10.0 * omega, 1.0);
  const double felt_N = largest_estimate(unpredicted(), 1.0, [&](double t) {
    return 0.1 * (-10.0 * omega * omega * std::sin(omega * t) + omega * std::cos(omega * t));
  });
  EXPECT_NEAR(felt_N, amplitude_N * omega * 0.0005, 0.02 * felt_N);
}

TEST(InverseModelEstimator, TheRationalFormOfMassAndDampingIsTheSameModel) {
  Params rational;
  rational.form = LinearModelForm::rational;
  auto a = InverseModelEstimator::make(Params{}, dt).value();
  auto b = InverseModelEstimator::make(rational, dt).value();
  for (int tick = 0; tick < 1000; ++tick) {
    const SlaveMotionSample sample{.command = std::cos(0.01 * tick), .position = std::sin(0.003 * tick)};
    EXPECT_EQ(a.step(sample).force, b.step(sample).force);
  }
}

TEST(InverseModelEstimator, FrictionIsAddedAtConstantVelocity) {
  Params params = unpredicted();
  params.friction = {.law = FrictionLaw::sigmoid, .force_N = 2.0, .velocity_scale_m_per_s = 0.5};
  auto estimator = InverseModelEstimator::make(params, dt).value();
  double force = 0.0;
  for (int tick = 0; tick < 2000; ++tick) force = estimator.step({.position = 1.5 * tick * dt.value}).force;
  const double r = 3.0;  // eq. 7 in the paper's own form
  EXPECT_NEAR(force, 1.5 + 2.0 * (1.0 / (1.0 + std::exp(-r)) - 0.5 + 0.1 * r + 0.00045 * r * r), 1e-6);
}

TEST(FrictionFunction, TheDeadBandIsSilentBelowItsScale) {
  const FrictionFunction friction{.law = FrictionLaw::dead_band_coulomb, .force_N = 2.0, .velocity_scale_m_per_s = 0.1};
  EXPECT_EQ(friction(0.09), 0.0);
  EXPECT_EQ(friction(-0.11), -2.0);
  const FrictionFunction smooth{.law = FrictionLaw::smooth_coulomb, .force_N = 2.0, .offset_N = 0.5};
  EXPECT_EQ(smooth(1.0), 2.5);
}

std::string refused(const Params& params) {
  const auto made = InverseModelEstimator::make(params, dt);
  return made ? "" : made.error().parameter + ": " + made.error().message;
}

TEST(InverseModelEstimator, AnUnstableInverseIsRefusedWithTheReason) {
  Params params;
  params.form = LinearModelForm::rational;
  params.plant.numerator_1 = -0.01;
  EXPECT_TRUE(refused(params).starts_with("plant.numerator_1: the plant has a zero that is not left"));
}

TEST(InverseModelEstimator, AnImproperInverseIsRefusedWithTheReason) {
  Params params;
  params.derivative_filter_s = 0.0;
  EXPECT_NE(refused(params).find("improper"), std::string::npos);
}

TEST(InverseModelEstimator, ADeclaredDelayThatIsNotPredictedIsRefusedWithTheReason) {
  Params params = unpredicted();
  params.declared_delay_s = 0.008;
  EXPECT_NE(refused(params).find("more than half of the delay is left"), std::string::npos);
  params.prediction = {.blocks = 2, .block = {.time_constant_s = 0.00425}};
  EXPECT_EQ(refused(params), "");
}

TEST(InverseModelEstimator, ARivalOfTheBlocksTakesASensorsDelayOutAsTheyDo) {
  // A mass in free motion whose position arrives 3 ms late; the derivative filter adds 0.5 ms.
  constexpr double delay_s = 0.003, omega = 2.0 * std::numbers::pi;
  Params params = unpredicted();
  params.viscous_damping_N_s_per_m = 0.0;
  const auto command = [&](double t) {
    return -params.mass_kg * 0.1 * omega * omega * std::sin(omega * (t + delay_s));
  };
  const double late_N = largest_estimate(params, 1.0, command);
  params.declared_delay_s = delay_s;
  params.prediction.polynomial.horizon_s = params.prediction.kalman.horizon_s = delay_s + params.derivative_filter_s;
  for (const auto kind : {signal::PredictionKind::polynomial, signal::PredictionKind::kalman}) {
    params.prediction.kind = kind;
    EXPECT_LT(largest_estimate(params, 1.0, command), 0.05 * late_N) << name_of(kind);
  }
  params.prediction.kalman.horizon_s = 0.0;
  EXPECT_NE(refused(params).find("set prediction.kalman.horizon_s near 0.0035"), std::string::npos) << refused(params);
}

TEST(InverseModelEstimator, NeitherMassNorDampingAndNoGainAreRefused) {
  Params params;
  params.mass_kg = params.viscous_damping_N_s_per_m = 0.0;
  EXPECT_TRUE(refused(params).starts_with("mass_kg"));
  params = {};
  params.actuator_gain = 0.0;
  EXPECT_TRUE(refused(params).starts_with("actuator_gain"));
}

}  // namespace inverse_model_estimator_test
}  // namespace tactus::control
