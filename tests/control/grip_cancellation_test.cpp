// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/stages/grip_cancellation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tactus::control {
namespace grip_cancellation_test {

static_assert(Element<GripCancellation>);

constexpr double tick_s = 200e-6;

GripCancellation::Params linear(OperatorEstimate estimate) {
  GripCancellation::Params params;
  params.estimate = estimate;
  MasterModel& master = params.cancellation.model.master;
  master.linkage.hysteretic_fraction = 0.0;
  master.motor.friction_N = 0.0;
  master.drum.friction_N = 0.0;
  return params;
}

GripCancellation make(const GripCancellation::Params& params) {
  return GripCancellation::make(params, Seconds{tick_s}).value();
}

/// A master in a hand as three masses on springs and dampers, integrated in steps of 1 µs straight from the equations
/// of motion. It shares no code with the model.
class Hand {
 public:
  explicit Hand(const MasterModel& master) : m_(master) {}
  void hold(double grip) { grip_ = grip; }
  void push(double motor_force_N) {
    constexpr int substeps = 200;
    constexpr double h = tick_s / substeps;
    for (int i = 0; i < substeps; ++i) {
      const double cable =
          m_.cable.stiffness_N_per_m * (motor_ - drum_) + m_.cable.damping_N_s_per_m * (motor_rate_ - drum_rate_);
      const double linkage =
          m_.linkage.stiffness_N_per_m * (drum_ - handle_) + m_.linkage.damping_N_s_per_m * (drum_rate_ - handle_rate_);
      const double hand = grip_ * (m_.hand.stiffness_N_per_m * handle_ + m_.hand.damping_N_s_per_m * handle_rate_);
      motor_rate_ += h * (motor_force_N - cable) / m_.motor.mass_kg;
      drum_rate_ += h * (cable - linkage) / m_.drum.mass_kg;
      handle_rate_ += h * (linkage - hand) / m_.handle.mass_kg;
      motor_ += h * motor_rate_;
      drum_ += h * drum_rate_;
      handle_ += h * handle_rate_;
    }
  }
  [[nodiscard]] double motor_m() const { return motor_; }

 private:
  MasterModel m_;
  double grip_ = 1.0;
  double motor_ = 0.0, drum_ = 0.0, handle_ = 0.0;
  double motor_rate_ = 0.0, drum_rate_ = 0.0, handle_rate_ = 0.0;
};

/// What a tap with chatter displays: 0.4 N to and fro at 25 Hz.
double chatter_N(int tick) { return (tick / 100) % 2 == 0 ? -0.4 : 0.4; }

/// A person's reach and tremor.
double path_m(int tick) {
  const double time_s = tick * tick_s;
  return 0.01 * std::sin(2.0 * 3.14159 * 1.5 * time_s) + 5e-5 * std::sin(2.0 * 3.14159 * 10.0 * time_s);
}

struct Outcome {
  double grip;
  double residual_m;  ///< root mean square over the last 0.2 s of the estimated less the true path, changes alone
};

/// Displays chatter for 0.5 s to a person who holds `grip` times as firmly as the model believes.
Outcome after_chatter(GripCancellation& cancellation, Hand& hand, double grip, double sensor = 1.0) {
  constexpr int ticks = 2500, judged = 1000;
  hand.hold(grip);
  double sum = 0.0, square = 0.0;
  for (int tick = 0; tick < ticks; ++tick) {
    const double measured_m = path_m(tick) + hand.motor_m();
    const double error_m =
        cancellation.step({.measured_position_m = measured_m, .motor_force_N = chatter_N(tick), .grip = sensor}) -
        path_m(tick);
    hand.push(chatter_N(tick));
    if (tick >= ticks - judged) {
      sum += error_m;
      square += error_m * error_m;
    }
  }
  const double mean = sum / judged;
  return {.grip = cancellation.grip(), .residual_m = std::sqrt(square / judged - mean * mean)};
}

TEST(GripCancellation, OnlineFindsTheGripOfAHandThatItIsNotTold) {
  const auto params = linear(OperatorEstimate::online);
  for (const double grip : {0.25, 0.5, 1.0, 2.0, 4.0}) {
    GripCancellation cancellation = make(params);
    Hand hand(params.cancellation.model.master);
    EXPECT_NEAR(std::log2(after_chatter(cancellation, hand, grip).grip), std::log2(grip), 0.1) << grip;
  }
}

TEST(GripCancellation, OnlineFollowsAGripThatChangesByAFactorOfFourAndBack) {
  const auto params = linear(OperatorEstimate::online);
  GripCancellation cancellation = make(params);
  Hand hand(params.cancellation.model.master);
  for (const double grip : {1.0, 0.25, 1.0, 4.0, 1.0}) {
    EXPECT_NEAR(std::log2(after_chatter(cancellation, hand, grip).grip), std::log2(grip), 0.1) << grip;
  }
}

TEST(GripCancellation, OnlineFindsGripsThatAreNoPowersOfTwo) {
  const auto params = linear(OperatorEstimate::online);
  for (const double grip : {0.35, 0.7, 1.5, 3.0}) {
    GripCancellation cancellation = make(params);
    Hand hand(params.cancellation.model.master);
    EXPECT_NEAR(std::log2(after_chatter(cancellation, hand, grip).grip), std::log2(grip), 0.1) << grip;
  }
}

TEST(GripCancellation, OnlineFollowsALinkageThatWasIdentifiedTooStiffWhereKnowingTheHandIsNotEnough) {
  const MasterModel truth = linear(OperatorEstimate::off).cancellation.model.master;
  auto params = linear(OperatorEstimate::online);
  params.cancellation.model.master.linkage.stiffness_N_per_m *= 1.05;
  GripCancellation online = make(params);
  params.estimate = OperatorEstimate::off;
  params.cancellation.model.master = held(params.cancellation.model.master, 4.0);
  GripCancellation told = make(params);
  Hand hand(truth), likewise(truth);
  EXPECT_LT(after_chatter(online, hand, 4.0).residual_m, 0.25 * after_chatter(told, likewise, 4.0).residual_m);
}

TEST(GripCancellation, NoSampleMovesTheCommandBeyondItselfByMoreThanAStepOfTheEncoder) {
  GripCancellation cancellation = make(linear(OperatorEstimate::online));
  Hand hand(linear(OperatorEstimate::online).cancellation.model.master);
  hand.hold(0.25);
  constexpr double step_m = 1e-5;
  double largest_m = 0.0;
  for (int tick = 0; tick < 2500; ++tick) {
    GripCancellation likewise = cancellation;
    const double measured_m = path_m(tick) + hand.motor_m();
    (void)likewise.intended(measured_m + 1e-3, 1.0);
    (void)cancellation.intended(measured_m, 1.0);
    ASSERT_EQ(likewise.induced_position_m(), cancellation.induced_position_m()) << tick;
    likewise.advance(chatter_N(tick));
    cancellation.advance(chatter_N(tick));
    hand.push(chatter_N(tick));
    // What a sample tells is applied at the next tick.
    GripCancellation next = cancellation;
    const double next_m = path_m(tick + 1) + hand.motor_m();
    (void)likewise.intended(next_m, 1.0);
    (void)next.intended(next_m, 1.0);
    const double apart_m = std::fabs(likewise.induced_position_m() - next.induced_position_m());
    ASSERT_LE(apart_m, 2.0 * step_m + 1e-12) << tick;
    largest_m = std::max(largest_m, apart_m);
  }
  EXPECT_GT(largest_m, 0.5 * step_m);  // or nothing was tried
}

TEST(GripCancellation, ALightHandIsShownAnImpactWholeAndOfWhatLastsAsMuchLessAsItHoldsLessFirmly) {
  GripCancellation cancellation = make(linear(OperatorEstimate::online));
  Hand hand(linear(OperatorEstimate::online).cancellation.model.master);
  ASSERT_LT(after_chatter(cancellation, hand, 0.25).grip, 0.27);
  // The surprise of the first impacts still takes some of all force away.
  const double whole_N = cancellation.admissible_N(4.0, 10.0);
  EXPECT_GT(whole_N, 3.0);
  double shown_N = 0.0;
  for (int tick = 0; tick < 1500; ++tick) shown_N = cancellation.admissible_N(4.0, 10.0);
  EXPECT_NEAR(shown_N, whole_N * cancellation.grip(), 0.05);
  EXPECT_EQ(cancellation.admissible_N(0.0, 10.0), 0.0);
}

TEST(GripCancellation, MotionThatNoHandExplainsTakesForceAwayAndQuietGivesItBack) {
  GripCancellation cancellation = make(linear(OperatorEstimate::online));
  const auto shake = [&](int ticks, double amplitude_m) {
    for (int tick = 0; tick < ticks; ++tick) {
      (void)cancellation.step({.measured_position_m = amplitude_m * std::sin(2.0 * 3.14159 * 150.0 * tick * tick_s)});
    }
  };
  shake(500, 5e-5);  // 35 um RMS: what a model that fits leaves
  EXPECT_EQ(cancellation.admissible_N(1.0, 10.0), 1.0);
  shake(500, 2.83e-4);  // 200 um RMS: four times what is borne
  EXPECT_NEAR(cancellation.admissible_N(1.0, 10.0), 0.25, 0.03);
  shake(25000, 0.0);
  EXPECT_GT(cancellation.admissible_N(1.0, 10.0), 0.98);
}

TEST(GripCancellation, OnlyAnOnlineEstimateShowsLessThanIsWanted) {
  for (const auto estimate : {OperatorEstimate::off, OperatorEstimate::scheduled}) {
    GripCancellation cancellation = make(linear(estimate));
    for (int tick = 0; tick < 500; ++tick) (void)cancellation.step({.measured_position_m = 0.01 * (tick % 2)});
    EXPECT_EQ(cancellation.admissible_N(25.0, 10.0), 25.0);
    EXPECT_EQ(cancellation.hand().estimated_grip_deviation, 0.0);
  }
}

TEST(GripCancellation, OnlineWithAnEulerStepIsRefused) {
  auto params = linear(OperatorEstimate::online);
  params.cancellation.model.step = CancellationStep::euler;
  const auto made = GripCancellation::make(params, Seconds{tick_s});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().parameter, "cancellation.model.step");
}

TEST(GripCancellation, KnowingTheGripLeavesATenthOfWhatTheFixedModelLeavesInALightHand) {
  double residual_m[3];
  for (const auto estimate : {OperatorEstimate::off, OperatorEstimate::online, OperatorEstimate::scheduled}) {
    const auto params = linear(estimate);
    GripCancellation cancellation = make(params);
    Hand hand(params.cancellation.model.master);
    residual_m[static_cast<int>(estimate)] = after_chatter(cancellation, hand, 0.25, 0.25).residual_m;
  }
  EXPECT_GT(residual_m[0], 1e-4);
  // Online, |W| is left on purpose: 0.1 / |1 + j 25/15| at the 25 Hz of the chatter.
  const double kept = 0.1 / std::hypot(1.0, 25.0 / 15.0);
  EXPECT_LT(residual_m[1], (0.1 + kept) * residual_m[0]);
  EXPECT_LT(residual_m[2], 0.1 * residual_m[0]);
}

TEST(GripCancellation, ScheduledTakesTheGripOfTheSensorBetweenTheHandsAndTheNearestBeyondThem) {
  const struct {
    double sensor, grip;
  } cases[] = {{1.0, 1.0},
               {0.7, 0.7},
               {3.0, 3.0},
               {0.01, 0.25},
               {100.0, 4.0},
               {0.0, 1.0},
               {-2.0, 1.0},
               {std::numeric_limits<double>::quiet_NaN(), 1.0},
               {std::numeric_limits<double>::infinity(), 4.0}};
  for (const auto& [sensor, grip] : cases) {
    GripCancellation cancellation = make(linear(OperatorEstimate::scheduled));
    for (int tick = 0; tick < 1000; ++tick) (void)cancellation.step({.grip = sensor});
    EXPECT_NEAR(cancellation.grip(), grip, 1e-6) << sensor;
  }
}

TEST(GripCancellation, APersonWhoMovesWithoutAForceIsNoEvidence) {
  GripCancellation cancellation = make(linear(OperatorEstimate::online));
  for (int tick = 0; tick < 10000; ++tick) {
    (void)cancellation.step({.measured_position_m = 0.3 + 20.0 * path_m(tick)});
    ASSERT_EQ(cancellation.grip(), 1.0);
  }
}

TEST(GripCancellation, OnlineForgetsAGripThatNothingShowsAnyMore) {
  const auto params = linear(OperatorEstimate::online);
  GripCancellation cancellation = make(params);
  Hand hand(params.cancellation.model.master);
  ASSERT_LT(after_chatter(cancellation, hand, 0.25).grip, 0.27);
  const auto rest = [&](double duration_s) {
    for (int tick = 0; tick < duration_s / tick_s; ++tick) {
      (void)cancellation.step({.measured_position_m = path_m(tick) + hand.motor_m()});
      hand.push(0.0);
    }
  };
  rest(0.5);
  EXPECT_LT(cancellation.grip(), 0.5);
  rest(15.0);
  EXPECT_GT(cancellation.grip(), 0.95);
}

TEST(GripCancellation, OffItIsCancellationWithTheFixedModel) {
  GripCancellation::Params params;
  GripCancellation bank = make(params);
  Cancellation fixed = Cancellation::make(params.cancellation, Seconds{tick_s}).value();
  for (int tick = 0; tick < 5000; ++tick) {
    ASSERT_EQ(bank.step({.measured_position_m = path_m(tick), .motor_force_N = chatter_N(tick), .grip = 0.25}),
              fixed.step({.measured_position_m = path_m(tick), .motor_force_N = chatter_N(tick)}));
  }
}

TEST(GripCancellation, InANominalHandTheBankCancelsAsTheFixedModelDoes) {
  GripCancellation bank = make(linear(OperatorEstimate::scheduled));
  GripCancellation fixed = make(linear(OperatorEstimate::off));
  for (int tick = 0; tick < 5000; ++tick) {
    ASSERT_EQ(bank.step({.measured_position_m = path_m(tick), .motor_force_N = chatter_N(tick)}),
              fixed.step({.measured_position_m = path_m(tick), .motor_force_N = chatter_N(tick)}));
  }
}

}  // namespace grip_cancellation_test
}  // namespace tactus::control
