// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/bonded_run.hpp>
#include <tactus/analysis/stability/margins.hpp>

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <tests/stability/linear_rig.hpp>

namespace tactus::stability {
namespace {

double simulated_over_linear(const simulation::Teleoperator::Params& params) {
  const double linear = gain_limit(*make_loop(params)).force_gain;
  return bisect_linear_limit(params, 0.8 * linear, 1.25 * linear).gain / linear;
}

TEST(BondedRun, TheBisectedLimitOfALinearRigMeetsTheLinearOneWithinOnePercent) {
  for (const double delay_s : {0.0, 0.0025}) {
    simulation::Teleoperator::Params params = linear_rig();
    params.channel.to_slave.delay_s = delay_s;
    params.channel.to_master.delay_s = delay_s;
    params.control.cancellation = control::CancellationMode::off;
    EXPECT_NEAR(simulated_over_linear(params), 1.0, 0.01) << "cancellation off, delay " << delay_s;
    params.control.cancellation = control::CancellationMode::on;
    misjudge_mass(params, 1.2);
    EXPECT_NEAR(simulated_over_linear(params), 1.0, 0.01) << "cancellation on, delay " << delay_s;
  }
}

TEST(BondedRun, SoItDoesWithAPerfectModelWhichLeavesSoLittleThatAnyHalfStepWouldShow) {
  // A force that reached the motor half a substep early moved this limit by 10 % at 10 us.
  for (const double step_s : {2e-5, 1e-5}) {
    simulation::Teleoperator::Params params = linear_rig();
    params.plant.longest_step_s = step_s;
    EXPECT_NEAR(simulated_over_linear(params), 1.0, 0.01) << step_s;
  }
}

TEST(BondedRun, StagesOfTheMasterSiteMoveBothLimitsAlike) {
  const control::ControlParams plain = linear_rig().control;
  std::vector<control::ControlParams> with(4, plain);
  with[0].crossover.frequency_Hz = 30.0;
  with[1].hand_compensation_Hz = 200.0;
  with[2].damping.damping_N_s_per_m = 2.0;
  with[3].crossover.frequency_Hz = 60.0;
  with[3].hand_compensation_Hz = 150.0;
  with[3].command_filter = {.kind = control::Shaping::low_pass, .frequency_Hz = 150.0};
  for (std::size_t i = 0; i < with.size(); ++i) {
    simulation::Teleoperator::Params params = linear_rig();
    params.control = with[i];
    misjudge_mass(params, 1.2);
    const auto loop = make_loop(params);
    ASSERT_TRUE(loop) << describe(loop.error());
    ASSERT_TRUE(std::isfinite(gain_limit(*loop).force_gain)) << i;
    EXPECT_NEAR(simulated_over_linear(params), 1.0, 0.02) << i;
  }
}

TEST(BondedRun, TheLinearVersionOfARigIsOneThatTheLinearLoopTakesForTheSame) {
  simulation::Teleoperator::Params params;
  params.environment.law = mechanics::ContactLaw::hunt_crossley;
  const GainLimit before = gain_limit(*make_loop(params)), after = gain_limit(*make_loop(linear_version(params)));
  EXPECT_NEAR(after.force_gain, before.force_gain, 1e-6 * before.force_gain);
}

}  // namespace
}  // namespace tactus::stability
