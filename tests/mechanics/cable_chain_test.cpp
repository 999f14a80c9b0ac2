// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/cable_chain.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/mechanics/reference_chain.hpp"
#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace cable_chain_test {

static_assert(Element<CableChain>);

constexpr double step_s = 40e-6;

CableChain chain(const ReferenceChain& reference, double dt_s = step_s) {
  return CableChain::make(reference.params(), reference.grip(), Seconds{dt_s}).value();
}

ReferenceChain undamped() {
  ReferenceChain reference;
  reference.cable_N_s_per_m = 0.0;
  reference.linkage_N_s_per_m = 0.0;
  return reference;
}

double momentum(const CableChain& mechanism, const ReferenceChain& reference) {
  const auto& v = mechanism.state().velocity_m_per_s;
  return reference.motor_kg * v[0] + reference.drum_kg * v[1] + reference.tip_kg * v[2];
}

/// Frequency in Hz of an oscillation about zero, from its first to its last upward crossing.
double frequency_of(const std::vector<double>& samples, double dt_s) {
  std::vector<double> crossings;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i - 1] < 0.0 && samples[i] >= 0.0) {
      crossings.push_back(static_cast<double>(i) - samples[i] / (samples[i] - samples[i - 1]));
    }
  }
  if (crossings.size() < 2) return 0.0;
  return static_cast<double>(crossings.size() - 1) / ((crossings.back() - crossings.front()) * dt_s);
}

/// What position Verlet makes of a mode: sin(ω_h h/2) = ω h/2.
double stepped_Hz(double mode_rad_per_s, double dt_s) {
  return std::asin(0.5 * mode_rad_per_s * dt_s) / (std::numbers::pi * dt_s);
}

TEST(CableChain, FreeModesRingAtTheEigenfrequenciesOfTheClosedForm) {
  const ReferenceChain reference = undamped();
  const auto modes = reference.free_modes();
  EXPECT_NEAR(modes[1] / (2.0 * std::numbers::pi), 480.0, 10.0);
  for (const double mode : modes) {
    const auto shape = reference.free_shape(mode);
    CableChain mechanism = chain(reference);
    mechanism.step({.motor_force_N = 1.0});
    std::vector<double> swing;
    for (int i = 0; i < 50000; ++i) {
      mechanism.step({});
      const auto& x = mechanism.state().position_m;
      swing.push_back(reference.motor_kg * shape[0] * x[0] + reference.drum_kg * shape[1] * x[1] +
                      reference.tip_kg * shape[2] * x[2]);
    }
    const double rung_Hz = frequency_of(swing, step_s);
    EXPECT_NEAR(rung_Hz / stepped_Hz(mode, step_s), 1.0, 1e-5);
    EXPECT_NEAR(rung_Hz / (mode / (2.0 * std::numbers::pi)), 1.0, 1e-3);
  }
}

TEST(CableChain, WithTheTipHeldMotorAndDrumRingOnTheLinkageNear74HzAndOnTheCable) {
  ReferenceChain reference = undamped();
  const auto modes = reference.held_modes();
  EXPECT_GT(modes[0] / (2.0 * std::numbers::pi), 73.0);
  EXPECT_LT(modes[0] / (2.0 * std::numbers::pi), 75.0);
  reference.grip_N_s_per_m = 1e12;
  for (const double mode : modes) {
    const double drum_swing = 1.0 - mode * mode * reference.motor_kg / reference.cable_N_per_m;
    CableChain mechanism = chain(reference);
    mechanism.step({.motor_force_N = 1.0});
    std::vector<double> swing;
    for (int i = 0; i < 50000; ++i) {
      mechanism.step({});
      const auto& x = mechanism.state().position_m;
      swing.push_back(reference.motor_kg * x[0] + reference.drum_kg * drum_swing * x[1]);
    }
    EXPECT_NEAR(frequency_of(swing, step_s) / stepped_Hz(mode, step_s), 1.0, 1e-5);
    EXPECT_NEAR(mechanism.tip_position_m(), 0.0, 1e-10);
  }
}

TEST(CableChain, WithoutLossesTheEnergyOfTheSchemeIsConservedToRoundOffAndThatOfTheBodiesToSecondOrder) {
  ReferenceChain reference = undamped();
  reference.grip_N_per_m = 40.0;
  double earlier_spread = 0.0;
  for (const double dt_s : {80e-6, 40e-6}) {
    CableChain mechanism = chain(reference, dt_s);
    for (long i = 0; i < std::lround(0.8e-3 / dt_s); ++i) {
      mechanism.step({.motor_force_N = 5.0, .tip_force_N = -2.0});
    }
    double least = 1e9, most = 0.0, first = 0.0;
    for (int i = 0; i < 200000; ++i) {
      mechanism.step({});
      const auto& [x, v, linkage] = mechanism.state();
      // A quadratic form of K: the energy in the springs of anything that is like a deflection.
      const auto in_springs = [&](const std::array<double, 3>& u) {
        return 0.5 * (reference.cable_N_per_m * (u[0] - u[1]) * (u[0] - u[1]) +
                      reference.linkage_N_per_m * (u[1] - u[2]) * (u[1] - u[2]) + reference.grip_N_per_m * u[2] * u[2]);
      };
      const double energy = in_springs(x) + 0.5 * (reference.motor_kg * v[0] * v[0] + reference.drum_kg * v[1] * v[1] +
                                                   reference.tip_kg * v[2] * v[2]);
      // Position Verlet conserves ½ vᵀ (M − h²/4 K) v + ½ xᵀ K x.
      const double conserved = energy - 0.25 * dt_s * dt_s * in_springs(v);
      if (i == 0) first = conserved;
      ASSERT_NEAR(conserved / first, 1.0, 1e-11) << "after " << i << " steps";
      least = std::min(least, energy);
      most = std::max(most, energy);
    }
    const double spread = (most - least) / first;
    EXPECT_LT(spread, 0.02);
    if (earlier_spread > 0.0) {
      EXPECT_NEAR(earlier_spread / spread, 4.0, 0.4);
    }
    earlier_spread = spread;
  }
}

TEST(CableChain, ASmoothMotionConvergesWithTheSquareOfTheStepToThatOfAnAdaptiveIntegrator) {
  ReferenceChain reference;
  reference.linkage_N_s_per_m = 0.5;
  reference.grip_N_per_m = 40.0;
  reference.grip_N_s_per_m = 23.0;
  const auto force_N = [](double time_s) { return std::sin(300.0 * time_s); };
  const auto grip_m = [](double time_s) { return 1e-3 * std::sin(40.0 * time_s); };
  const auto grip_m_per_s = [](double time_s) { return 40e-3 * std::cos(40.0 * time_s); };
  constexpr double end_s = 0.02;
  const auto end = reference.integrate({}, end_s, [&](double time_s, const ReferenceChain::State&) {
    return ReferenceChain::Forces{
        .motor_N = force_N(time_s),
        .tip_N = reference.grip_N_per_m * grip_m(time_s) + reference.grip_N_s_per_m * grip_m_per_s(time_s)};
  });

  std::array<double, 6> earlier{};
  for (const double dt_s : {80e-6, 40e-6, 20e-6}) {
    CableChain mechanism = chain(reference, dt_s);
    const long steps = std::lround(end_s / dt_s);
    for (long i = 0; i < steps; ++i) {
      const double middle_s = (static_cast<double>(i) + 0.5) * dt_s;
      mechanism.step({.motor_force_N = force_N(middle_s),
                      .grip_position_m = grip_m(middle_s),
                      .grip_velocity_m_per_s = grip_m_per_s(middle_s)});
    }
    for (std::size_t i = 0; i < 6; ++i) {
      const double reached = i < 3 ? mechanism.state().position_m[i] : mechanism.state().velocity_m_per_s[i - 3];
      const double error = std::fabs(reached - end[i]);
      EXPECT_LT(error, 0.02 * std::fabs(end[i])) << i << " at " << dt_s;
      if (earlier[i] > 0.0) {
        EXPECT_NEAR(earlier[i] / error, 4.0, 0.1) << i << " at " << dt_s;
      }
      earlier[i] = error;
    }
  }
}

TEST(CableChain, AForceBelowTheMotorsFrictionMovesNothingAtAll) {
  for (const double force_N : {0.00123, -0.007, 0.0099999}) {
    CableChain mechanism = CableChain::make({}, Seconds{step_s}).value();
    for (int i = 0; i < 20000; ++i) mechanism.step({.motor_force_N = force_N});
    for (std::size_t body = 0; body < 3; ++body) {
      EXPECT_EQ(mechanism.state().position_m[body], 0.0);
      EXPECT_EQ(mechanism.state().velocity_m_per_s[body], 0.0);
    }
  }
}

TEST(CableChain, AForceThatRisesToJustBelowBothFrictionsOnlyStretchesTheCable) {
  const CableChain::Params params;
  CableChain mechanism = CableChain::make(params, Seconds{step_s}).value();
  const double most_N = 0.999 * (params.motor.friction_N + params.drum.friction_N);
  constexpr int steps = 500000;
  for (int i = 0; i <= steps; ++i) mechanism.step({.motor_force_N = most_N * i / steps});
  const double stretch_m = (most_N - params.motor.friction_N) / params.cable.stiffness_N_per_m;
  EXPECT_NEAR(mechanism.motor_position_m(), stretch_m, 1e-3 * stretch_m);
  EXPECT_NEAR(mechanism.state().position_m[1], 0.0, 1e-18);
  EXPECT_NEAR(mechanism.tip_position_m(), 0.0, 1e-18);
}

TEST(CableChain, AForceAboveBothFrictionsAcceleratesTheWholeByWhatFrictionLeaves) {
  const CableChain::Params params;
  CableChain mechanism = CableChain::make(params, Seconds{step_s}).value();
  const ReferenceChain masses;
  constexpr double force_N = 0.5;
  // The first 10 ms are the start, where friction does not yet act in full on every body.
  for (int i = 0; i < 250; ++i) mechanism.step({.motor_force_N = force_N});
  const double before = momentum(mechanism, masses);
  constexpr int steps = 10000;
  for (int i = 0; i < steps; ++i) mechanism.step({.motor_force_N = force_N});
  EXPECT_NEAR(momentum(mechanism, masses) - before,
              steps * step_s * (force_N - params.motor.friction_N - params.drum.friction_N), 1e-12);
}

TEST(CableChain, SlidingFreelyTheMomentumFallsLinearlyByTheFrictionAndThenMotorAndDrumRest) {
  const CableChain::Params params;
  CableChain mechanism = CableChain::make(params, Seconds{step_s}).value();
  const ReferenceChain masses;
  constexpr int push_steps = 12500;
  for (int i = 0; i < push_steps; ++i) {
    mechanism.step({.motor_force_N = 0.05 * std::sin(std::numbers::pi * i / push_steps)});
  }
  const double start = momentum(mechanism, masses);
  const double friction_N = params.motor.friction_N + params.drum.friction_N;
  const int sliding_steps = static_cast<int>(0.8 * start / (friction_N * step_s));
  ASSERT_GT(sliding_steps, 1000);
  for (int i = 1; i <= sliding_steps; ++i) {
    mechanism.step({});
    ASSERT_GT(mechanism.state().velocity_m_per_s[0], 0.0);
    ASSERT_GT(mechanism.state().velocity_m_per_s[1], 0.0);
    ASSERT_NEAR(momentum(mechanism, masses), start - i * step_s * friction_N, 1e-13);
  }
  for (int i = 0; i < 250000; ++i) mechanism.step({});
  EXPECT_NEAR(mechanism.state().velocity_m_per_s[0], 0.0, 1e-10);
  EXPECT_NEAR(mechanism.state().velocity_m_per_s[1], 0.0, 1e-10);
}

TEST(CableChain, FrictionStopsAndReleasesMotorAndDrumWhenThePiecewiseSolutionOfScipyDoes) {
  const OracleTable table("mechanics_rubbing_chain");
  const auto forces_N = table.column("motor_force_N");
  const std::array reference{table.column("motor_m"), table.column("drum_m"), table.column("tip_m")};
  CableChain::Params params;
  params.linkage.hysteretic_fraction = 0.0;
  const LinearSpring::Params grip{.stiffness_N_per_m = 40.0, .damping_N_s_per_m = 23.0};
  constexpr double sample_s = 200e-6;

  std::array<double, 2> rms_m{};
  for (const int substeps : {5, 20}) {
    CableChain mechanism = CableChain::make(params, grip, Seconds{sample_s / substeps}).value();
    double sum = 0.0;
    for (std::size_t sample = 0; sample < forces_N.size(); ++sample) {
      for (std::size_t body = 0; body < 3; ++body) {
        const double error_m = mechanism.state().position_m[body] - reference[body][sample];
        sum += error_m * error_m;
      }
      for (int i = 0; i < substeps; ++i) mechanism.step({.motor_force_N = forces_N[sample]});
    }
    rms_m[substeps == 5 ? 0 : 1] = std::sqrt(sum / static_cast<double>(3 * forces_N.size()));
  }
  const double travel_m = *std::max_element(reference[0].begin(), reference[0].end());
  EXPECT_LT(rms_m[0], 1e-3 * travel_m);
  EXPECT_LT(rms_m[1], 0.3 * rms_m[0]);
}

TEST(CableChain, TheMomentumChangesByTheImpulseOfTheOuterForces) {
  ReferenceChain reference;
  reference.grip_N_per_m = 40.0;
  reference.grip_N_s_per_m = 23.0;
  CableChain mechanism = chain(reference);
  for (int i = 0; i < 5000; ++i) {
    const double phase = 0.01 * i;
    const CableChain::Input input{.motor_force_N = std::sin(phase),
                                  .tip_force_N = -0.5 * std::cos(3.0 * phase),
                                  .grip_position_m = 1e-3 * std::sin(0.2 * phase),
                                  .grip_velocity_m_per_s = 0.05 * std::cos(0.2 * phase)};
    const double before = momentum(mechanism, reference);
    const double tip_m = mechanism.tip_position_m();
    const double tip_m_per_s = mechanism.tip_velocity_m_per_s();
    mechanism.step(input);
    const double tip_middle_m = tip_m + 0.5 * step_s * tip_m_per_s;
    const double tip_middle_m_per_s = 0.5 * (tip_m_per_s + mechanism.tip_velocity_m_per_s());
    const double grip_N =
        40.0 * (input.grip_position_m - tip_middle_m) + 23.0 * (input.grip_velocity_m_per_s - tip_middle_m_per_s);
    ASSERT_NEAR(momentum(mechanism, reference) - before, step_s * (input.motor_force_N + input.tip_force_N + grip_N),
                1e-16);
  }
}

TEST(CableChain, TwoPartsOfAStepEndWhereTheWholeDoesToThirdOrder) {
  ReferenceChain reference;
  reference.grip_N_per_m = 40.0;
  reference.grip_N_s_per_m = 23.0;
  double earlier_m = 0.0;
  for (const double dt_s : {40e-6, 20e-6, 10e-6}) {
    CableChain whole = chain(reference, dt_s);
    const CableChain::Input input{.motor_force_N = 1.0};
    double largest_m = 0.0;
    for (long i = 0; i < std::lround(8e-3 / dt_s); ++i) {
      CableChain parts = whole;
      whole.step(input);
      parts.advance(input, 0.37 * dt_s);
      parts.advance(input, 0.63 * dt_s);
      for (std::size_t body = 0; body < 3; ++body) {
        largest_m = std::max(largest_m, std::fabs(whole.state().position_m[body] - parts.state().position_m[body]));
      }
    }
    EXPECT_LT(largest_m, 1e-8);
    if (earlier_m > 0.0) {
      EXPECT_NEAR(earlier_m / largest_m, 8.0, 1.0);
    }
    earlier_m = largest_m;
  }
}

TEST(CableChain, AnAdvanceByNoTimeChangesNothing) {
  CableChain mechanism = CableChain::make({}, Seconds{step_s}).value();
  for (int i = 0; i < 100; ++i) mechanism.step({.motor_force_N = 1.0});
  const CableChain::State before = mechanism.state();
  mechanism.advance({.motor_force_N = 7.0, .tip_force_N = -3.0}, 0.0);
  for (std::size_t body = 0; body < 3; ++body) {
    EXPECT_EQ(mechanism.state().position_m[body], before.position_m[body]);
    EXPECT_DOUBLE_EQ(mechanism.state().velocity_m_per_s[body], before.velocity_m_per_s[body]);
  }
}

TEST(CableChain, ASlowCycleOfTheTipLosesTheAreaOfTheLinkagesLoopAndHasItsAverageStiffness) {
  CableChain::Params params;
  params.motor.friction_N = 1e3;
  params.drum.friction_N = 1e3;
  CableChain mechanism = CableChain::make(params, Seconds{step_s}).value();
  const ElastoSlipSpring::Params& linkage = params.linkage;
  const double most_N = linkage.stiffness_N_per_m * linkage.reference_deflection_m;
  constexpr int steps_a_cycle = 50000;
  double lost_J = 0.0, tip_most_m = 0.0;
  for (int i = 0; i < 2 * steps_a_cycle; ++i) {
    const double force_N = most_N * std::sin(2.0 * std::numbers::pi * (i + 0.5) / steps_a_cycle);
    const double before_m = mechanism.tip_position_m();
    mechanism.step({.tip_force_N = force_N});
    if (i < steps_a_cycle) continue;
    lost_J += force_N * (mechanism.tip_position_m() - before_m);
    tip_most_m = std::max(tip_most_m, mechanism.tip_position_m());
  }
  EXPECT_NEAR(tip_most_m, linkage.reference_deflection_m, 2e-3 * linkage.reference_deflection_m);

  // Four sliders that slip at 1/4, 1/2, 3/4 and all of the slip deflection and share the hysteretic part of K₀.
  double kept = 1.0 - linkage.hysteretic_fraction, area = 0.0;
  for (int i = 1; i <= 4; ++i) {
    const double slip_m = 0.25 * i * linkage.slip_deflection_m;
    kept += 0.25 * linkage.hysteretic_fraction * slip_m / linkage.reference_deflection_m;
    area += linkage.hysteretic_fraction * slip_m * (linkage.reference_deflection_m - slip_m);
  }
  const double area_J = area * linkage.stiffness_N_per_m / kept;
  EXPECT_NEAR(lost_J, area_J, 0.02 * area_J);
}

TEST(CableChain, AMirroredForceGivesTheMirroredMotionBitForBit) {
  CableChain one = CableChain::make({}, Seconds{step_s}).value();
  CableChain other = one;
  for (int i = 0; i < 5000; ++i) {
    const double force_N = 0.3 * std::sin(0.013 * i) + 0.1 * std::sin(0.171 * i);
    const CableChain::Output left = one.step({.motor_force_N = force_N, .tip_force_N = -0.2 * force_N});
    const CableChain::Output right = other.step({.motor_force_N = -force_N, .tip_force_N = 0.2 * force_N});
    ASSERT_EQ(left.motor_position_m, -right.motor_position_m);
    ASSERT_EQ(left.tip_position_m, -right.tip_position_m);
  }
}

TEST(CableChain, AfterAResetItRestsWhereItWasPutWithTheLinkageRelaxed) {
  const LinearSpring::Params grip{.stiffness_N_per_m = 40.0, .damping_N_s_per_m = 23.0};
  CableChain mechanism = CableChain::make({}, grip, Seconds{step_s}).value();
  for (int i = 0; i < 2000; ++i) mechanism.step({.motor_force_N = 2.0});
  mechanism.reset(0.03);
  for (int i = 0; i < 1000; ++i) mechanism.step({.grip_position_m = 0.03});
  for (std::size_t body = 0; body < 3; ++body) {
    EXPECT_EQ(mechanism.state().position_m[body], 0.03);
    EXPECT_EQ(mechanism.state().velocity_m_per_s[body], 0.0);
  }
}

TEST(CableChain, TheLongestStepThatMakeTakesIsTwoOverTheHighestEigenfrequency) {
  const ReferenceChain reference = undamped();
  const double longest_s = 2.0 / reference.free_modes()[1];
  EXPECT_TRUE(CableChain::make(reference.params(), Seconds{0.9999 * longest_s}));
  EXPECT_FALSE(CableChain::make(reference.params(), Seconds{1.0001 * longest_s}));
}

TEST(CableChain, AStepTooLongForAStiffnessIsRefusedWithTheStiffnessNamed) {
  CableChain::Params params;
  params.cable.stiffness_N_per_m = 1e9;
  EXPECT_EQ(CableChain::make(params, Seconds{step_s}).error().parameter, "cable.stiffness_N_per_m");
  params = {};
  params.linkage.stiffness_N_per_m = 1e9;
  EXPECT_EQ(CableChain::make(params, Seconds{step_s}).error().parameter, "linkage.stiffness_N_per_m");
  const auto held = CableChain::make({}, {.stiffness_N_per_m = 1e9, .damping_N_s_per_m = 23.0}, Seconds{step_s});
  EXPECT_EQ(held.error().parameter, "grip.stiffness_N_per_m");
}

}  // namespace cable_chain_test
}  // namespace tactus::mechanics
