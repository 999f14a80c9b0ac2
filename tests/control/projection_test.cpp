// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/projection.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace tactus::control {
namespace projection_test {

constexpr double tick_s = 200e-6;
/// Table I: motor, drum and handle; friction of motor and drum.
constexpr double mass_kg = 0.0075 + 0.01075 + 0.014;
constexpr double friction_N = 0.01 + 0.0144;

HandForceObserver observer(double rubbing_N = 0.0, double cutoff_Hz = 30.0) {
  return HandForceObserver::make({.mass_kg = mass_kg, .friction_N = rubbing_N, .cutoff_Hz = cutoff_Hz}, Seconds{tick_s})
      .value();
}

/// A free mass under forces held over each tick, exactly.
struct FreeBody {
  double x_m = 0.0, v_m_per_s = 0.0;
  void advance(double force_N) {
    const double a = force_N / mass_kg;
    x_m += tick_s * v_m_per_s + 0.5 * tick_s * tick_s * a;
    v_m_per_s += tick_s * a;
  }
};

TEST(HandForceObserver, DoesNotTakeWhatTheMotorDoesToAFreeMassForAHand) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> force(-1.0, 1.0);
  HandForceObserver hand = observer();
  FreeBody body{.x_m = 0.03};
  for (int tick = 0; tick < 20000; ++tick) {
    const double motor_N = force(random);
    ASSERT_NEAR(hand.step({body.x_m, motor_N}), 0.0, 1e-7) << tick;
    body.advance(motor_N);
  }
}

TEST(HandForceObserver, FindsASteadyHandForceWhateverTheMotorDoes) {
  HandForceObserver hand = observer();
  FreeBody body;
  double estimate_N = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    const double motor_N = 0.8 * std::sin(0.3 * tick);
    estimate_N = hand.step({body.x_m, motor_N});
    body.advance(motor_N + 0.25);
  }
  EXPECT_NEAR(estimate_N, 0.25, 1e-6);
}

TEST(HandForceObserver, FindsTheForceOfAHandThatHoldsTheMotorStill) {
  HandForceObserver hand = observer();
  double estimate_N = 0.0;
  for (int tick = 0; tick < 2000; ++tick) estimate_N = hand.step({0.02, -0.6});
  EXPECT_NEAR(estimate_N, 0.6, 1e-9);
}

TEST(HandForceObserver, ASteadyMotionWithoutMotorForceTakesTheFrictionOfTheDevice) {
  for (const double way : {-1.0, 1.0}) {
    HandForceObserver hand = observer(friction_N);
    double estimate_N = 0.0;
    for (int tick = 0; tick < 2000; ++tick) estimate_N = hand.step({way * 0.05 * tick_s * tick, 0.0});
    EXPECT_NEAR(estimate_N, way * friction_N, 1e-9);
  }
}

TEST(HandForceObserver, LosesThreeDecibelsOfAnAlternatingHandForceAtItsCutoff) {
  for (const double cutoff_Hz : {10.0, 50.0}) {
    HandForceObserver hand = observer(0.0, cutoff_Hz);
    const double omega = 2.0 * std::numbers::pi * cutoff_Hz;
    double largest_N = 0.0;
    for (int tick = 0; tick < 10000; ++tick) {
      // The path of a mass under a unit sine of force.
      const double position_m = -std::sin(omega * tick_s * tick) / (mass_kg * omega * omega);
      const double estimate_N = hand.step({position_m, 0.0});
      if (tick > 5000) largest_N = std::max(largest_N, std::fabs(estimate_N));
    }
    EXPECT_NEAR(largest_N, std::numbers::sqrt2 / 2.0, 1e-3) << cutoff_Hz;
  }
}

TEST(HandForceObserver, OneCountOfTheEncoderMakesNoMoreNoiseThanStated) {
  HandForceObserver hand = observer();
  double largest_N = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    largest_N = std::max(largest_N, std::fabs(hand.step({tick < 1000 ? 0.0 : 1e-5, 0.0})));
  }
  const double stated_N = mass_kg * std::pow(2.0 * std::numbers::pi * 30.0, 2) * 1e-5;
  EXPECT_LE(largest_N, stated_N);
  EXPECT_GE(largest_N, 0.5 * stated_N);
}

TEST(HeldForce, IsTheForceCutToWhatLiesBetweenZeroAndTheHandForce) {
  for (double hand_N = -3.0; hand_N <= 3.0; hand_N += 0.125) {
    if (std::fabs(hand_N) < 0.02) continue;
    for (double force_N = -2.0; force_N <= 2.0; force_N += 0.0625) {
      const double expected = std::clamp(force_N, std::fmin(0.0, hand_N), std::fmax(0.0, hand_N));
      ASSERT_NEAR(held_force_N(force_N, hand_N, 0.02), expected, 1e-12) << force_N << " " << hand_N;
    }
  }
}

TEST(HeldForce, FadesWithTheHandForceWhereThatIsNegligible) {
  EXPECT_NEAR(held_force_N(0.01, 0.01, 0.02), 0.01 * 0.25, 1e-15);
  EXPECT_NEAR(held_force_N(0.01, -0.01, 0.02), 0.0, 1e-15);
  EXPECT_NEAR(held_force_N(-0.02, -0.005, 0.02), -0.005 * 0.25, 1e-15);
  EXPECT_NEAR(held_force_N(5.0, 0.01, 0.02), 0.01, 1e-15);
  EXPECT_EQ(held_force_N(5.0, 0.0, 0.02), 0.0);
}

TEST(HeldForce, NeverExceedsForceOrHandNeverTurnsAndNeverJumps) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  constexpr double negligible_N = 0.05;
  for (int i = 0; i < 100000; ++i) {
    const double size = std::pow(10.0, normal(random));
    const double force_N = size * normal(random), hand_N = 0.1 * normal(random);
    const double held_N = held_force_N(force_N, hand_N, negligible_N);
    ASSERT_LE(std::fabs(held_N), std::fabs(force_N) * (1.0 + 1e-15));
    ASSERT_LE(std::fabs(held_N), std::fabs(hand_N));
    ASSERT_GE(held_N * force_N, 0.0);
    // Slopes: at most 1 in either force where the hand counts; where it counts less, 2 in the hand force times the
    // share of the force that it passes, which is below the ratio of force and threshold.
    const double step_N = 1e-6 * normal(random);
    const double steepest = std::max(1.0, 2.0 * std::fabs(force_N) / negligible_N);
    ASSERT_LE(std::fabs(held_force_N(force_N, hand_N + step_N, negligible_N) - held_N),
              steepest * std::fabs(step_N) + 1e-14 * size);
    ASSERT_LE(std::fabs(held_force_N(force_N + step_N, hand_N, negligible_N) - held_N),
              std::fabs(step_N) + 1e-14 * size);
  }
}

MasterInput input(double position_m, double tip_force_N) {
  return {.motor_position_m = position_m, .arrival = {.message = {.force_N = tip_force_N}, .fresh = true}};
}

ProjectionMaster master(double unconditional_fraction) {
  ProjectionMaster::Params params;
  params.position_force.force_gain = 2.0;
  params.projection.unconditional_fraction = unconditional_fraction;
  return ProjectionMaster::make(params, Seconds{tick_s}).value();
}

TEST(ProjectionMaster, AHandThatHoldsTheHandleStillComesToFeelAllOfTheForceEitherWay) {
  for (const double tip_N : {0.3, -0.3}) {
    ProjectionMaster site = master(0.1);
    double force_N = 0.0;
    EXPECT_NEAR(site.step(input(0.0, tip_N)).motor_force_N, -0.1 * 2.0 * tip_N, 1e-12) << "at once only alpha of it";
    for (int tick = 0; tick < 5000; ++tick) force_N = site.step(input(0.0, tip_N)).motor_force_N;
    EXPECT_NEAR(force_N, -2.0 * tip_N, 1e-6);
  }
}

TEST(ProjectionMaster, AHandleThatNobodyHoldsIsGivenOnlyTheUnconditionalFraction) {
  for (const double fraction : {0.0, 0.1, 0.5, 1.0}) {
    ProjectionMaster::Params params;
    params.position_force.model.motor.friction_N = 0.0;
    params.position_force.model.drum.friction_N = 0.0;
    params.projection.unconditional_fraction = fraction;
    ProjectionMaster site = ProjectionMaster::make(params, Seconds{tick_s}).value();
    FreeBody body;
    for (int tick = 0; tick < 1000; ++tick) {
      const double tip_N = 0.5 + 0.3 * std::sin(0.05 * tick);
      const double force_N = site.step(input(body.x_m, tip_N)).motor_force_N;
      ASSERT_NEAR(force_N, -fraction * tip_N, 1e-6) << tick;
      body.advance(force_N);
    }
  }
}

TEST(ProjectionMaster, AHandThatPushesHarderThanTheForceFeelsAllOfItAtOnce) {
  ProjectionMaster site = master(0.1);
  FreeBody body;
  for (int tick = 0; tick < 1000; ++tick) {
    site.step(input(body.x_m, 0.0));
    body.advance(2.0 - friction_N);
  }
  EXPECT_NEAR(site.step(input(body.x_m, 0.4)).motor_force_N, -0.8, 1e-9);
  EXPECT_NEAR(site.step(input(body.x_m, -0.4)).motor_force_N, 0.1 * 0.8, 1e-9) << "a force that helps is not held";
}

TEST(ProjectionMaster, TheDisplayedForceLiesBetweenTheUnconditionalShareAndAllOfTheSaturatedForce) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  ProjectionMaster site = master(0.2);
  double position_m = 0.0;
  for (int tick = 0; tick < 20000; ++tick) {
    position_m += 1e-5 * normal(random);
    const double tip_N = normal(random);
    const double whole_N = std::clamp(2.0 * tip_N, -1.0, 1.0);
    const double shown_N = -site.step(input(position_m, tip_N)).motor_force_N;
    ASSERT_GE(shown_N * std::copysign(1.0, tip_N), 0.2 * std::fabs(whole_N) - 1e-12);
    ASSERT_LE(shown_N * std::copysign(1.0, tip_N), std::fabs(whole_N) + 1e-12);
  }
}

TEST(ProjectionMaster, TheObserverIsDrivenByTheForceThatTheGateLetThrough) {
  // The gate passes a tenth; a handle held still balances that, so the hand is known to hold no more.
  ProjectionMaster::Params params;
  params.projection.unconditional_fraction = 0.1;
  MasterSite site(master_controller(ProjectionMaster::make(params, Seconds{tick_s}).value()),
                  SafetyGate::make({.force_limit_N = 0.05}, Seconds{tick_s}).value());
  ProjectionMaster open = ProjectionMaster::make(params, Seconds{tick_s}).value();
  double gated_N = 0.0;
  for (int tick = 0; tick < 5000; ++tick) {
    gated_N = site.step(input(0.0, 0.5)).motor_force_N;
    open.respond(input(0.0, 0.5));
    open.applied(-0.05);
  }
  EXPECT_EQ(gated_N, -0.05);
  EXPECT_NEAR(open.respond(input(0.0, 0.5)).motor_force_N, -(0.1 * 0.5 + 0.9 * 0.05), 1e-9);
}

}  // namespace projection_test
}  // namespace tactus::control
