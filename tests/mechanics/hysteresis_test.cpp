// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/bouc_wen.hpp>
#include <tactus/kernel/mechanics/elasto_slip.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace hysteresis_test {

static_assert(Element<ElastoSlipSpring>);
static_assert(Element<BoucWenSpring>);

constexpr Seconds substep{40e-6};
constexpr double amplitude_m = 2.5e-4;

ElastoSlipSpring elasto_slip(ElastoSlipSpring::Params params = {}) {
  return ElastoSlipSpring::make(params, substep).value();
}
BoucWenSpring bouc_wen(BoucWenSpring::Params params = {}) { return BoucWenSpring::make(params, substep).value(); }

/// Moves slowly to a deflection in that many equal steps, so that no viscous force acts, and returns the forces.
template <class Spring>
std::vector<double> move(Spring& spring, double from_m, double to_m, int steps) {
  std::vector<double> forces_N;
  for (int i = 1; i <= steps; ++i) {
    forces_N.push_back(spring.step({.deflection_m = from_m + (to_m - from_m) * i / steps, .rate_m_per_s = 0.0}));
  }
  return forces_N;
}

struct Loop {
  double secant_N_per_m;
  double area_J;
  std::vector<double> upward_N;
};

/// A closed loop between ±amplitude, after as many loops as it takes the spring to get there: both are exact for
/// steps of any size, so a loop of two steps will do. Bouc–Wen needs many where it hardly slips.
template <class Spring>
Loop closed_loop(Spring spring, double loop_amplitude_m, double start_m = 0.0) {
  constexpr int steps = 20000;
  move(spring, 0.0, start_m, 100);
  move(spring, start_m, loop_amplitude_m, 100);
  for (int i = 0; i < 1000; ++i) {
    move(spring, loop_amplitude_m, -loop_amplitude_m, 1);
    move(spring, -loop_amplitude_m, loop_amplitude_m, 1);
  }
  const double top_N = spring.step({.deflection_m = loop_amplitude_m, .rate_m_per_s = 0.0});
  const auto down = move(spring, loop_amplitude_m, -loop_amplitude_m, steps);
  const auto up = move(spring, -loop_amplitude_m, loop_amplitude_m, steps);
  const double step_m = 2.0 * loop_amplitude_m / steps;
  double area_J = 0.0;
  for (std::size_t i = 0; i < up.size(); ++i) {
    area_J += 0.5 * step_m * (up[i] + (i == 0 ? down.back() : up[i - 1]));
    area_J -= 0.5 * step_m * (down[i] + (i == 0 ? top_N : down[i - 1]));
  }
  return {.secant_N_per_m = (up.back() - down.back()) / (2.0 * loop_amplitude_m), .area_J = area_J, .upward_N = up};
}

TEST(ElastoSlipSpring, TheChordOfAClosedLoopHasTheAverageStiffness) {
  for (const double fraction : {0.0, 0.1, 0.3, 0.9}) {
    for (const double slip_m : {2e-5, 1e-4, 2.4e-4, 6e-4}) {
      const auto spring = elasto_slip({.hysteretic_fraction = fraction, .slip_deflection_m = slip_m});
      EXPECT_NEAR(closed_loop(spring, amplitude_m).secant_N_per_m, 3950.0, 1e-6) << fraction << ", " << slip_m;
      EXPECT_NEAR(closed_loop(spring, amplitude_m, 7e-4).secant_N_per_m, 3950.0, 1e-6) << "started elsewhere";
    }
  }
}

TEST(ElastoSlipSpring, IsStiffFromRestAndSofterTheLargerTheLoop) {
  auto spring = elasto_slip();
  const double tiny_N = spring.step({.deflection_m = 1e-6, .rate_m_per_s = 0.0});
  EXPECT_NEAR(tiny_N / 1e-6, spring.initial_stiffness_N_per_m(), 1e-6);
  EXPECT_NEAR(spring.sustained_stiffness_N_per_m(), 0.7 * spring.initial_stiffness_N_per_m(), 1e-9);
  EXPECT_GT(closed_loop(elasto_slip(), 0.5 * amplitude_m).secant_N_per_m, 3950.0);
  EXPECT_LT(closed_loop(elasto_slip(), 2.0 * amplitude_m).secant_N_per_m, 3950.0);
}

TEST(ElastoSlipSpring, LosesTheClosedFormEnergyInALoop) {
  for (const double slip_m : {2e-5, 1e-4, 2.4e-4, 6e-4}) {
    const auto spring = elasto_slip({.hysteretic_fraction = 0.5, .slip_deflection_m = slip_m});
    const double part_N_per_m = 0.5 * spring.initial_stiffness_N_per_m() / 4.0;
    double expected_J = 0.0;
    for (const double share : {0.25, 0.5, 0.75, 1.0}) {
      expected_J += 4.0 * part_N_per_m * share * slip_m * std::max(0.0, amplitude_m - share * slip_m);
    }
    EXPECT_NEAR(closed_loop(spring, amplitude_m).area_J, expected_J, 1e-6 * 3950.0 * amplitude_m * amplitude_m);
  }
}

TEST(ElastoSlipSpring, EveryBranchIsTheBackboneTwiceAsLargeAsMasingSays) {
  auto spring = elasto_slip();
  const double top_N = move(spring, 0.0, amplitude_m, 10).back();
  for (int i = 0; i <= 100; ++i) {
    const double back_m = 2.0 * amplitude_m * i / 100.0;
    ElastoSlipSpring branch = spring;
    const double drop_N = top_N - branch.step({.deflection_m = amplitude_m - back_m, .rate_m_per_s = 0.0});
    const double backbone_N = elasto_slip().step({.deflection_m = 0.5 * back_m, .rate_m_per_s = 0.0});
    EXPECT_NEAR(drop_N, 2.0 * backbone_N, 1e-12);
  }
}

TEST(ElastoSlipSpring, FollowsTheForceFormOfTheEquationsOnARandomWalk) {
  const ElastoSlipSpring::Params params{.hysteretic_fraction = 0.6};
  auto spring = elasto_slip(params);
  const double initial_N_per_m = spring.initial_stiffness_N_per_m();
  std::array<double, 4> parts_N{};
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> change(-3e-5, 3e-5);
  double deflection_m = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double change_m = std::clamp(change(engine), -4e-4 - deflection_m, 4e-4 - deflection_m);
    deflection_m += change_m;
    double expected_N = 0.4 * initial_N_per_m * deflection_m;
    for (std::size_t n = 0; n < 4; ++n) {
      const double part_N_per_m = 0.15 * initial_N_per_m;
      const double slip_N = part_N_per_m * params.slip_deflection_m * 0.25 * (static_cast<double>(n) + 1.0);
      parts_N[n] = std::clamp(parts_N[n] + part_N_per_m * change_m, -slip_N, slip_N);
      expected_N += parts_N[n];
    }
    ASSERT_NEAR(spring.step({.deflection_m = deflection_m, .rate_m_per_s = 0.0}), expected_N, 1e-10);
  }
}

TEST(ElastoSlipSpring, ItsFractionZeroIsALinearSpring) {
  auto spring = elasto_slip({.damping_N_s_per_m = 0.5, .hysteretic_fraction = 0.0});
  for (const double deflection_m : {1e-3, -2e-4, 5e-5, 0.0}) {
    EXPECT_NEAR(spring.step({.deflection_m = deflection_m, .rate_m_per_s = 0.1}), 3950.0 * deflection_m + 0.05, 1e-12);
  }
}

TEST(ElastoSlipSpring, NeverGivesBackMoreEnergyThanItHolds) {
  auto spring = elasto_slip({.hysteretic_fraction = 0.8});
  std::mt19937_64 engine(6);
  std::normal_distribution<double> normal;
  double deflection_m = 0.0;
  double force_N = 0.0;
  double supplied_J = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double target_m = 2e-4 * normal(engine);
    const double step_m = (target_m - deflection_m) / 2000.0;
    for (int n = 0; n < 2000; ++n) {
      deflection_m += step_m;
      const double next_N = spring.step({.deflection_m = deflection_m, .rate_m_per_s = 0.0});
      supplied_J += 0.5 * step_m * (force_N + next_N);
      force_N = next_N;
    }
    double held_J = 0.5 * spring.sustained_stiffness_N_per_m() * deflection_m * deflection_m;
    const auto& elements = spring.elements();
    for (std::size_t n = 0; n < elements.count; ++n) {
      const double stretch_m = deflection_m - elements.slider_m[n];
      held_J += 0.5 * elements.stiffness_N_per_m[n] * stretch_m * stretch_m;
    }
    ASSERT_GE(supplied_J, held_J - 1e-9);
  }
}

template <class Spring>
void expect_rate_independence(const Spring& spring) {
  Spring coarse = spring;
  Spring fine = spring;
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal;
  double deflection_m = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double target_m = 1.5e-4 * normal(engine);
    const double coarse_N = coarse.step({.deflection_m = target_m, .rate_m_per_s = 0.0});
    const double fine_N = move(fine, deflection_m, target_m, 1 + i % 37).back();
    ASSERT_NEAR(coarse_N, fine_N, 1e-12);
    deflection_m = target_m;
  }
}

TEST(Hysteresis, DoesNotDependOnHowManyStepsAStretchTakes) {
  expect_rate_independence(elasto_slip());
  expect_rate_independence(bouc_wen());
}

TEST(Hysteresis, AMinorLoopClosesInTheElastoSlipSpringAndNotInBoucWen) {
  const auto loss_N = [](auto spring) {
    const double before_N = move(spring, 0.0, 1e-4, 10).back();
    move(spring, 1e-4, 9.5e-5, 10);
    return before_N - move(spring, 9.5e-5, 1e-4, 10).back();
  };
  EXPECT_NEAR(loss_N(elasto_slip()), 0.0, 1e-15);
  EXPECT_GT(loss_N(bouc_wen()), 1e-3);
}

TEST(BoucWenSpring, FollowsTheDifferentialEquationAsScipyIntegratesIt) {
  const OracleTable table("mechanics_bouc_wen");
  const auto deflections_m = table.column("deflection_m");
  const auto elastic_m = table.column("elastic_m");
  auto spring = bouc_wen({.hysteretic_fraction = 0.6, .slip_deflection_m = 4e-5});
  const double initial_N_per_m = spring.initial_stiffness_N_per_m();
  double time_s = 0.0;
  for (std::size_t i = 0; i < deflections_m.size(); ++i) {
    // Between two stored instants the deflection may turn back, so it is retraced finely.
    for (const double end_s = 2e-3 * static_cast<double>(i); time_s < end_s - 1e-9; time_s += 1e-6) {
      const double next_s = time_s + 1e-6;
      spring.step({.deflection_m = 2e-4 * std::sin(4.0 * std::numbers::pi * next_s) +
                                   4e-5 * std::sin(46.0 * std::numbers::pi * next_s),
                   .rate_m_per_s = 0.0});
    }
    const double force_N = spring.step({.deflection_m = deflections_m[i], .rate_m_per_s = 0.0});
    ASSERT_NEAR(force_N, initial_N_per_m * (0.4 * deflections_m[i] + 0.6 * elastic_m[i]), 1e-6) << "row " << i;
  }
}

TEST(BoucWenSpring, TheChordAndTheAreaOfAClosedLoopAreAsStated) {
  for (const double slip_m : {1e-5, 6.5e-5, 3e-4, 2e-3}) {
    const auto spring = bouc_wen({.hysteretic_fraction = 0.5, .slip_deflection_m = slip_m});
    const Loop loop = closed_loop(spring, amplitude_m);
    EXPECT_NEAR(loop.secant_N_per_m, 3950.0, 1e-3);
    // The swing of z follows from the chord: it is what the loop shows beyond the spring that never slips.
    const double hysteretic_N_per_m = 0.5 * spring.initial_stiffness_N_per_m();
    const double tip_m = amplitude_m * (loop.secant_N_per_m / hysteretic_N_per_m - 1.0);
    const double expected_J = 2.0 * hysteretic_N_per_m * (2.0 * slip_m * (amplitude_m - tip_m) - 0.5 * tip_m * tip_m);
    EXPECT_NEAR(loop.area_J, expected_J, 1e-6 * 3950.0 * amplitude_m * amplitude_m);
  }
}

TEST(BoucWenSpring, ItsDefaultsMatchTheLoopOfTheElastoSlipSpring) {
  const Loop rival = closed_loop(bouc_wen(), amplitude_m);
  const Loop loop = closed_loop(elasto_slip(), amplitude_m);
  EXPECT_NEAR(rival.area_J / loop.area_J, 1.0, 0.005);
  for (std::size_t i = 0; i < loop.upward_N.size(); ++i) {
    ASSERT_NEAR(rival.upward_N[i], loop.upward_N[i], 0.01 * 3950.0 * amplitude_m);
  }
}

}  // namespace hysteresis_test
}  // namespace tactus::mechanics
