#include <tactus/stability/state_space.hpp>
#include <tactus/stability/z_width.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tactus::stability {
namespace {

/// Real part of the impedance of a device with damping b that renders a stiffness K, force held between samples, as the
/// worst hand sees it: Colgate and Brown's condition over frequency, b > T/2 · Re{(1 − e^{−jωT}) K} / (1 − cos ωT).
double worst_margin(double damping, double stiffness, double tick_s) {
  double worst = damping;
  for (int i = 1; i <= 200; ++i) {
    const double angle = std::numbers::pi * i / 200.0;
    worst = std::min(worst, damping - 0.5 * tick_s / (1.0 - std::cos(angle)) * stiffness * (1.0 - std::cos(angle)));
  }
  return worst;
}

/// Whether a mass with a damper is stable against a sampled spring that answers `delay_ticks` late.
bool stable(double mass, double damping, double stiffness, double tick_s, Eigen::Index delay_ticks) {
  StateSpace body{.a = Eigen::MatrixXd::Zero(2, 2),
                  .b = Eigen::MatrixXd::Zero(2, 1),
                  .c = Eigen::MatrixXd::Zero(1, 2),
                  .d = Eigen::MatrixXd::Zero(1, 1)};
  body.a(0, 1) = 1.0;
  body.a(1, 1) = -damping / mass;
  body.b(1, 0) = 1.0 / mass;
  body.c(0, 0) = 1.0;
  const StateSpace ticks = sampled(body, tick_s, 0.0);
  const Eigen::Index states = 2 + delay_ticks;
  const StateSpace loop = assemble(states, 0, 0, [&](const auto& state, const auto&, auto& next, auto&) {
    const double seen = delay_ticks > 0 ? state[states - 1] : state[0];
    next.head(2) = ticks.a * state.head(2) - ticks.b.col(0) * (stiffness * seen);
    for (Eigen::Index i = 2; i < states; ++i) next[i] = i == 2 ? state[0] : state[i - 1];
  });
  return poles(loop).cwiseAbs().maxCoeff() < 1.0;
}

TEST(ZWidth, PassiveStiffnessIsWhereColgateAndBrownsConditionEndsAtSomeFrequency) {
  const double limit = passive_stiffness_N_per_m(0.8, 0.0, 1e-3);
  EXPECT_DOUBLE_EQ(limit, 1600.0);
  EXPECT_GT(worst_margin(0.8, 0.999 * limit, 1e-3), 0.0);
  EXPECT_LT(worst_margin(0.8, 1.001 * limit, 1e-3), 0.0);
}

TEST(ZWidth, VirtualDampingOfEitherSignCostsPassiveStiffness) {
  EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m(0.8, 0.3, 1e-3), 1000.0);
  EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m(0.8, -0.3, 1e-3), 1000.0);
  EXPECT_DOUBLE_EQ(passive_stiffness_N_per_m(0.2, 0.3, 1e-3), 0.0);
}

TEST(ZWidth, FrictionMustHideAStepOfTheEncoder) {
  EXPECT_DOUBLE_EQ(quantised_stiffness_N_per_m(0.8, 1e-3, 0.02, 1e-4), 400.0);
  EXPECT_DOUBLE_EQ(quantised_stiffness_N_per_m(0.1, 1e-3, 0.02, 1e-4), 200.0);
  EXPECT_DOUBLE_EQ(quantised_stiffness_N_per_m(0.8, 1e-3, 0.02, 0.0), 1600.0);
  // A press through one step and back gains K Δ² / 2 at most, which friction takes on the way there and back.
  const double stiffness = quantised_stiffness_N_per_m(10.0, 1e-3, 0.02, 1e-4), step = 1e-4;
  EXPECT_NEAR(stiffness * step * step, 2.0 * 0.02 * step, 1e-12);
}

TEST(ZWidth, GilAndHulinsBoundIsWhereAHeavyBodyOnASampledSpringBecomesUnstable) {
  const double mass = 5.0, damping = 2.0, tick_s = 1e-3;
  for (const Eigen::Index delay : {0, 1, 3}) {
    const double bound = stable_stiffness_N_per_m(damping, 0.0, tick_s, tick_s * static_cast<double>(delay));
    EXPECT_TRUE(stable(mass, damping, 0.98 * bound, tick_s, delay)) << delay;
    EXPECT_FALSE(stable(mass, damping, 1.02 * bound, tick_s, delay)) << delay;
  }
}

}  // namespace
}  // namespace tactus::stability
