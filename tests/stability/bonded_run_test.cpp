#include <tactus/stability/bonded_run.hpp>
#include <tactus/stability/margins.hpp>

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

TEST(BondedRun, WithAPerfectModelTheLimitsMeetAsThePlantsAreSteppedEverMoreFinely) {
  // What is left of the induced motion is then so small that a plant's step, whose amplifier answers half a step early,
  // shows: by 10 % of the limit at 10 us. The gap goes with the step, so two steps tell where it ends.
  simulation::Teleoperator::Params params = linear_rig();
  params.plant.longest_step_s = 1e-5;
  const double coarse = simulated_over_linear(params);
  params.plant.longest_step_s = 5e-6;
  const double fine = simulated_over_linear(params);
  EXPECT_NEAR((coarse - 1.0) / (fine - 1.0), 2.0, 0.15);
  EXPECT_NEAR(2.0 * fine - coarse, 1.0, 0.01);
}

TEST(BondedRun, TheLinearVersionOfARigIsOneThatTheLinearLoopTakesForTheSame) {
  simulation::Teleoperator::Params params;
  params.environment.law = mechanics::ContactLaw::hunt_crossley;
  const GainLimit before = gain_limit(*make_loop(params)), after = gain_limit(*make_loop(linear_version(params)));
  EXPECT_NEAR(after.force_gain, before.force_gain, 1e-6 * before.force_gain);
}

}  // namespace
}  // namespace tactus::stability
