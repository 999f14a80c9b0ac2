// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/stages/cancellation.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::control {
namespace cancellation_test {

static_assert(Element<Cancellation>);

constexpr double tick_s = 200e-6;

/// The path of a hand beside which the plant is displaced.
double path_m(std::size_t tick) { return 1e-3 * std::sin(0.002 * static_cast<double>(tick)); }

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// A plant that SciPy integrated, equal to the model, and the forces that displaced it.
struct Plant {
  std::vector<double> force_N, induced_m;
  Plant() {
    const OracleTable table("control_induced_motion");
    force_N = table.column("motor_force_N");
    induced_m = table.column("rest_motor_m");
  }
};

Cancellation::Params at_rest() {
  Cancellation::Params params;
  params.model.master.linkage.hysteretic_fraction = 0.0;
  params.model.friction = ModelFriction::at_rest;
  return params;
}

/// What cancellation leaves of the induced motion where the sample is taken `lead` ticks after the instant that the
/// model stands for.
std::vector<double> residual(const Cancellation::Params& params, const Plant& plant, std::ptrdiff_t lead = 0) {
  Cancellation cancellation = Cancellation::make(params, Seconds{tick_s}).value();
  std::vector<double> left_m;
  for (std::size_t tick = 1; tick + 1 < plant.force_N.size(); ++tick) {
    const auto sampled = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(tick) + lead);
    const double intended_m = cancellation.step(
        {.measured_position_m = plant.induced_m[sampled] + path_m(tick), .motor_force_N = plant.force_N[tick]});
    left_m.push_back(intended_m - path_m(tick));
  }
  return left_m;
}

TEST(Cancellation, WithAPlantLikeTheModelWhatIsLeftIsThePathOfTheHand) {
  const Plant plant;
  const double induced_m = rms(plant.induced_m);
  EXPECT_LT(rms(residual(at_rest(), plant)), 5e-4 * induced_m);
  Cancellation::Params euler = at_rest();
  euler.model.step = CancellationStep::euler;
  EXPECT_LT(rms(residual(euler, plant)), 5e-3 * induced_m);
}

TEST(Cancellation, TheModelBelongsToTheSampleOfTheSameInstant) {
  const Plant plant;
  const double aligned_m = rms(residual(at_rest(), plant));
  EXPECT_GT(rms(residual(at_rest(), plant, 1)), 5.0 * aligned_m);
  EXPECT_GT(rms(residual(at_rest(), plant, -1)), 5.0 * aligned_m);
}

/// What second differences over 8 ms leave, mostly above 20 Hz: the slow part is the hand's business.
std::vector<double> fast_part(const std::vector<double>& values) {
  constexpr std::size_t spacing = 40;
  std::vector<double> fast;
  for (std::size_t i = spacing; i + spacing < values.size(); ++i) {
    fast.push_back(values[i] - 0.5 * (values[i - spacing] + values[i + spacing]));
  }
  return fast;
}

TEST(Cancellation, OneTickOfMisalignmentCostsAboutHalfAsMuchAsTenPercentOfStiffness) {
  const Plant plant;
  Cancellation::Params stiff = at_rest();
  stiff.model.master.linkage.stiffness_N_per_m *= 1.1;
  const double stiffness_m = rms(fast_part(residual(stiff, plant)));
  for (const std::ptrdiff_t lead : {-1, 1}) {
    const double misaligned_m = rms(fast_part(residual(at_rest(), plant, lead)));
    EXPECT_GT(misaligned_m, 0.35 * stiffness_m);
    EXPECT_LT(misaligned_m, 0.7 * stiffness_m);
  }
}

TEST(Cancellation, WithoutForceItReturnsTheMeasuredPositionItself) {
  Cancellation cancellation = Cancellation::make({}, Seconds{tick_s}).value();
  for (std::size_t tick = 0; tick < 5000; ++tick) {
    ASSERT_EQ(cancellation.step({.measured_position_m = path_m(tick)}), path_m(tick));
  }
}

TEST(Cancellation, ItsResultDoesNotDependOnTheForceThatIsYetToAct) {
  Cancellation one = Cancellation::make({}, Seconds{tick_s}).value();
  for (int tick = 0; tick < 100; ++tick) one.step({.measured_position_m = 1e-4, .motor_force_N = -0.5});
  Cancellation other = one;
  EXPECT_EQ(one.step({.measured_position_m = 1e-4, .motor_force_N = 1.0}),
            other.step({.measured_position_m = 1e-4, .motor_force_N = -1.0}));
  EXPECT_NE(one.step({}), other.step({}));
}

/// Drives a moving hand's plant and returns what is left of the induced motion.
double left_of_moving_hand_m(ModelFriction friction, const Plant& plant, double speed_m_per_s,
                             const std::vector<double>& induced_m) {
  Cancellation::Params params;
  params.model.master.linkage.hysteretic_fraction = 0.0;
  params.model.friction = friction;
  Cancellation cancellation = Cancellation::make(params, Seconds{tick_s}).value();
  // The hand has been moving for a second when the forces begin.
  double at_m = 0.0;
  for (int tick = 0; tick < 5000; ++tick) {
    cancellation.step({.measured_position_m = at_m});
    at_m += speed_m_per_s * tick_s;
  }
  std::vector<double> left_m;
  for (std::size_t tick = 0; tick < plant.force_N.size(); ++tick) {
    left_m.push_back(
        cancellation.step({.measured_position_m = at_m + induced_m[tick], .motor_force_N = plant.force_N[tick]}) -
        at_m);
    at_m += speed_m_per_s * tick_s;
  }
  return rms(left_m);
}

TEST(Cancellation, FrictionOnTotalVelocityKnowsThatAMovingHandHasOvercomeItAlready) {
  const Plant plant;
  const auto induced_m = OracleTable("control_induced_motion").column("fast_motor_m");
  const double total_m = left_of_moving_hand_m(ModelFriction::total_velocity, plant, -0.05, induced_m);
  const double rest_m = left_of_moving_hand_m(ModelFriction::at_rest, plant, -0.05, induced_m);
  EXPECT_LT(total_m, 0.5 * rest_m);
  EXPECT_LT(total_m, 0.01 * rms(induced_m));
}

TEST(Cancellation, AModelThatCannotBeMadeIsRefusedUnderItsName) {
  Cancellation::Params unstable;
  unstable.model.step = CancellationStep::euler;
  unstable.model.master.cable.stiffness_N_per_m = 1e9;
  const auto refused = Cancellation::make(unstable, Seconds{tick_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "model.step");
  const auto late = Cancellation::make({}, Seconds{0.02});
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().parameter, "dt");
}

}  // namespace cancellation_test
}  // namespace tactus::control
