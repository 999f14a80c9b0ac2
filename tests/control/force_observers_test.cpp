// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/estimators/disturbance_observer.hpp>
#include <tactus/kernel/control/estimators/kalman_force_estimator.hpp>
#include <tactus/kernel/control/estimators/momentum_observer.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

// Observers of the environment's force against exact motions of the body that they believe in.
namespace tactus::control {
namespace force_observers_test {

constexpr Seconds tick{200e-6};
constexpr double mass_kg = 0.032;

/// Steady amplitude of the estimate over the true force for a body that a sinusoidal force shakes.
template <class Observer>
double amplitude_ratio(Observer observer, double frequency_Hz) {
  const double omega = 2.0 * std::numbers::pi * frequency_Hz;
  const double amplitude_m = 1.0 / (mass_kg * omega * omega);  // of a force of 1 N
  const auto periods = [&](double count) { return static_cast<int>(std::lround(count / (frequency_Hz * tick.value))); };
  std::complex<double> sum = 0.0;
  const int settling = periods(40.0);
  const int window = periods(20.0);
  for (int n = 0; n < settling + window; ++n) {
    const double force = observer.step({.position = -amplitude_m * std::sin(omega * n * tick.value)}).force;
    if (n >= settling) sum += force * std::polar(1.0, -omega * n * tick.value);
  }
  return std::abs(sum) * 2.0 / window;
}

TEST(DisturbanceObserver, SeesTheForceThroughItsLowPass) {
  const auto observer = DisturbanceObserver::make({.model = {.mass_kg = mass_kg}, .cutoff_Hz = 100.0}, tick).value();
  EXPECT_NEAR(amplitude_ratio(observer, 10.0), 1.0, 0.001);
  EXPECT_NEAR(amplitude_ratio(observer, 100.0), std::numbers::sqrt2 / 2.0, 0.003);
  EXPECT_NEAR(amplitude_ratio(observer, 500.0), 1.0 / std::hypot(1.0 - 25.0, std::numbers::sqrt2 * 5.0), 0.003);
}

TEST(MomentumObserver, FollowsAStepOfForceWithItsTimeConstant) {
  constexpr Seconds fine{1e-5};
  auto observer = MomentumObserver::make(
                      {.model = {.mass_kg = mass_kg}, .cutoff_Hz = 20.0, .velocity = {.cutoff_Hz = 20000.0}}, fine)
                      .value();
  for (int n = 0; n <= 5000; ++n) {
    const double time_s = n * fine.value;
    const double force = observer.step({.position = 0.5 * time_s * time_s / mass_kg}).force;
    if (n < 100) continue;
    EXPECT_NEAR(force, 1.0 - std::exp(-2.0 * std::numbers::pi * 20.0 * time_s), 3e-3) << time_s;
  }
}

TEST(MomentumObserver, OnASlaveThatAWallHoldsAnswersACommandAsAGeometricSeries) {
  auto observer = MomentumObserver::make({.model = {.mass_kg = mass_kg, .actuator_gain = 2.0}}, tick).value();
  const double ratio = 1.0 - 2.0 * std::numbers::pi * 100.0 * tick.value;
  for (int n = 0; n < 200; ++n) {
    EXPECT_NEAR(observer.step({.command = 0.5, .position = 0.3}).force, -(1.0 - std::pow(ratio, n)), 1e-12) << n;
  }
}

TEST(KalmanForceEstimator, HasTheGainThatTheRiccatiEquationGives) {
  const OracleTable oracle("control_kalman");
  const auto column = [&oracle](const char* name) { return oracle.column(name); };
  for (std::size_t i = 0; i < column("mass_kg").size(); ++i) {
    const auto estimator = KalmanForceEstimator::make(
        {.model = {.mass_kg = column("mass_kg")[i], .viscous_damping_N_s_per_m = column("damping_N_s_per_m")[i]},
         .force_walk_N = column("force_walk_N")[i],
         .model_noise_N = column("model_noise_N")[i],
         .position_noise_m = column("position_noise_m")[i]},
        Seconds{column("dt_s")[i]});
    ASSERT_TRUE(estimator) << describe(estimator.error());
    for (std::size_t k = 0; k < 3; ++k) {
      const double expected = column(("gain_" + std::to_string(k)).c_str())[i];
      EXPECT_NEAR(estimator->gain()[k], expected, 1e-6 * expected) << "row " << i << ", gain " << k;
    }
  }
}

TEST(KalmanForceEstimator, FindsAConstantForceWithoutBias) {
  auto estimator = KalmanForceEstimator::make({.model = {.mass_kg = mass_kg}}, tick).value();
  double force = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const double time_s = n * tick.value;
    force = estimator.step({.command = 0.25, .position = 0.5 * 0.75 * time_s * time_s / mass_kg}).force;
  }
  EXPECT_NEAR(force, 0.5, 1e-6);
}

/// The estimate at the end of `seconds` of one motion.
template <class Observer, class Position>
double last_estimate(const SlaveModel& model, double command, double seconds, Position position_m) {
  typename Observer::Params params;
  params.model = model;
  auto observer = Observer::make(params, tick).value();
  double force = 0.0;
  for (double time_s = 0.0; time_s < seconds; time_s += tick.value) {
    force = observer.step({.command = command, .position = position_m(time_s)}).force;
  }
  return force;
}

template <class Observer>
class ForceObservers : public ::testing::Test {};
using Observers = ::testing::Types<DisturbanceObserver, MomentumObserver, KalmanForceEstimator>;
TYPED_TEST_SUITE(ForceObservers, Observers);

TYPED_TEST(ForceObservers, FeelAWallPushBackAgainstACommandThatItHolds) {
  const auto held = [](double) { return 0.0; };
  EXPECT_NEAR(last_estimate<TypeParam>({.mass_kg = mass_kg, .actuator_gain = 2.0}, 0.5, 1.0, held), -1.0, 1e-3);
}

TYPED_TEST(ForceObservers, TakeTheEffortOfSteadyMotionForFrictionAndNotForTheEnvironment) {
  const SlaveModel model{.mass_kg = mass_kg,
                         .viscous_damping_N_s_per_m = 2.0,
                         .friction = {.law = FrictionLaw::dead_band_coulomb, .force_N = 0.03, .offset_N = 0.01}};
  const double speed_m_per_s = 0.1;
  const double effort_N = 2.0 * speed_m_per_s + 0.03 + 0.01;
  const auto steady = [&](double time_s) { return speed_m_per_s * time_s; };
  EXPECT_NEAR(last_estimate<TypeParam>(model, effort_N, 2.0, steady), 0.0, 2e-3);
}

TYPED_TEST(ForceObservers, NameTheParameterThatIsOutOfBounds) {
  typename TypeParam::Params params;
  params.model.mass_kg = 0.0;
  const auto observer = TypeParam::make(params, tick);
  ASSERT_FALSE(observer);
  EXPECT_EQ(observer.error().parameter, "model.mass_kg");
}

TEST(ForceObserverCutoffs, AreRefusedWhereTheSampleRateCannotGiveThem) {
  EXPECT_EQ(MomentumObserver::make({.cutoff_Hz = 800.0}, tick).error().parameter, "cutoff_Hz");
  EXPECT_EQ(DisturbanceObserver::make({.cutoff_Hz = 2300.0}, tick).error().parameter, "cutoff_Hz");
}

}  // namespace force_observers_test
}  // namespace tactus::control
