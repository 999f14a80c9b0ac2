// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/bench_model.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace bench_model_test {

constexpr double tick_s = 200e-6;

BenchParams frictionless() {
  BenchParams params;
  params.master.motor.friction_N = params.master.drum.friction_N = 0.0;
  params.master.linkage.hysteretic_fraction = 0.0;
  return params;
}

RigRun commands(std::vector<double> force_N) {
  RigRun run;
  run.tick_s = tick_s;
  run.position_m.assign(force_N.size(), 0.0);
  run.commanded_force_N = std::move(force_N);
  return run;
}

/// x of a free mass behind a first-order lag: ∬ g (1 − exp(−w t)) F/m, t from when the command changes.
double free_mass_m(const BenchParams& params, double force_N, double time_s) {
  const double rate = 2.0 * std::numbers::pi * params.amplifier_bandwidth_Hz;
  const double t = time_s - (params.amplifier_lag_s - 1.0 / rate);
  if (t <= 0.0) return 0.0;
  return params.amplifier_gain * force_N / params.master.motor.mass_kg *
         (0.5 * t * t - t / rate + (1.0 - std::exp(-rate * t)) / (rate * rate));
}

TEST(BenchModel, AMotorAloneMovesAsAMassBehindADelayedLag) {
  for (const double bandwidth_Hz : {1500.0, 5000.0}) {
    for (const double delay_s : {0.0, 20e-6, 130e-6}) {
      BenchParams params = frictionless();
      params.amplifier_gain = 0.97;
      params.amplifier_bandwidth_Hz = bandwidth_Hz;
      params.amplifier_lag_s = delay_s + 1.0 / (2.0 * std::numbers::pi * bandwidth_Hz);
      const auto x = simulate_position(params, Assembly::motor, {}, commands(std::vector<double>(50, 0.5)), 1);
      for (std::size_t i = 5; i < x.size(); ++i) {
        EXPECT_NEAR(x[i], free_mass_m(params, 0.5, static_cast<double>(i) * tick_s), 1e-9)
            << bandwidth_Hz << " " << delay_s << " " << i;
      }
    }
  }
}

TEST(BenchModel, TheCurrentFollowsTheCommandAsAFirstOrderLagDoes) {
  BenchParams params;
  params.amplifier_gain = 1.03;
  params.amplifier_offset_N = 0.004;
  params.amplifier_bandwidth_Hz = 1500.0;
  params.amplifier_lag_s = 30e-6 + 1.0 / (2.0 * std::numbers::pi * 1500.0);
  const auto current = simulate_current(params, commands(std::vector<double>(20, 0.5)));
  EXPECT_EQ(current[0], 0.0);
  const double rate = 2.0 * std::numbers::pi * 1500.0;
  for (std::size_t i = 1; i < current.size(); ++i) {
    const double since_s = static_cast<double>(i) * tick_s - 30e-6;
    EXPECT_NEAR(current[i], (1.03 * 0.5 + 0.004) * (1.0 - std::exp(-rate * since_s)), 1e-12) << i;
  }
}

TEST(BenchModel, WithTheDrumLockedTheMotorRingsOnTheCable) {
  BenchParams params = frictionless();
  params.master.cable.damping_N_s_per_m = 0.0;
  params.amplifier_bandwidth_Hz = 1e6;
  params.amplifier_lag_s = 1e-6;
  const auto x = simulate_position(params, Assembly::cable, {}, commands(std::vector<double>(100, 1.0)), 4);
  const double natural = std::sqrt(39500.0 / 0.0075);
  for (std::size_t i = 1; i < x.size(); ++i) {
    EXPECT_NEAR(x[i], (1.0 - std::cos(natural * (static_cast<double>(i) * tick_s - 1e-6))) / 39500.0, 3e-7) << i;
  }
}

TEST(BenchModel, AHeldMasterFollowsASlowSineAsGripAndCorrectionSay) {
  // Far below its resonances the master is a rigid mass at the hand, and the hand's aim moves at −g times what is seen:
  // x = F / (−m ω² + (k + j ω b) (1 + g S/(j ω))), S = exp(−j ω delay)/(1 + j ω/ω_s); the links in series add 1/k each.
  BenchParams params = frictionless();
  params.amplifier_bandwidth_Hz = 1e5;
  params.amplifier_lag_s = 1e-5;
  const double frequency_Hz = 0.8, w = 2.0 * std::numbers::pi * frequency_Hz;
  const std::size_t period = static_cast<std::size_t>(1.0 / (frequency_Hz * tick_s));
  std::vector<double> force_N(8 * period);
  for (std::size_t i = 0; i < force_N.size(); ++i) force_N[i] = std::sin(w * tick_s * static_cast<double>(i));
  const auto x = simulate_position(params, Assembly::held, {}, commands(force_N), 1);
  using Complex = std::complex<double>;
  Complex found = 0.0;
  for (std::size_t i = force_N.size() - 2 * period; i < force_N.size(); ++i) {
    found += x[i] * std::polar(1.0, -w * tick_s * static_cast<double>(i));
  }
  found *= Complex(0.0, 1.0) / static_cast<double>(period);
  const double sight = 2.0 * std::numbers::pi * params.sight_bandwidth_Hz;
  const Complex s(0.0, w);
  const Complex seen = std::exp(-s * (params.reaction_time_s - 1.0 / sight)) / (1.0 + s / sight);
  const Complex hand = (40.0 + 23.0 * s) * (1.0 + params.correction_gain_per_s * seen / s);
  const Complex handle = 1.0 / (0.03225 * s * s + hand);
  const Complex expected = handle + (1.0 / 39500.0 + 1.0 / 3950.0) * hand * handle;
  EXPECT_NEAR(std::abs(found / expected - 1.0), 0.0, 4e-3);
}

TEST(BenchModel, WithFeedbackTheVirtualSpringHoldsTheModelToo) {
  // Commands of a run that a spring of 300 N/m made at rest at 0 under a constant push: the model, off by its own
  // friction and push, comes to rest where its own forces balance.
  BenchParams params = frictionless();
  params.bias_N = 0.03;
  MotorProgram program;
  program.stiffness_N_per_m = 300.0;
  program.damping_N_s_per_m = 1.0;
  const auto x = simulate_position(params, Assembly::motor, program, commands(std::vector<double>(5000, 0.0)), 1);
  EXPECT_NEAR(x.back(), 0.03 / 300.0, 1e-9);
}

TEST(BenchModel, ThinningAveragesCommandsAndPicksPositions) {
  RigRun run = commands({1.0, 2.0, 3.0, 4.0, 5.0});
  run.position_m = {0.1, 0.2, 0.3, 0.4, 0.5};
  const RigRun thin = thinned(run, 2);
  EXPECT_DOUBLE_EQ(thin.tick_s, 2.0 * tick_s);
  EXPECT_EQ(thin.commanded_force_N, (std::vector<double>{1.5, 3.5}));
  EXPECT_EQ(thin.position_m, (std::vector<double>{0.1, 0.3}));
}

}  // namespace bench_model_test
}  // namespace tactus::identification
