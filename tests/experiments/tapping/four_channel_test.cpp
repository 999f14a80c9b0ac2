// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/four_channel.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

namespace tactus::experiments {
namespace four_channel_test {

using Records = std::vector<simulation::Teleoperator::Record>;

/// The tapping experiment without anything random, and with nothing that rubs, slips, counts or saturates.
simulation::Teleoperator::Params ideal_four_channel(const std::string& architecture) {
  simulation::Teleoperator::Params params = experiment_file<TappingParams>("tapping");
  params.control.architecture = architecture;
  params.control.force_limit_N = 10.0;
  params.person.tremor_amplitude_m = 0.0;
  params.person.correction.gain_per_s = 0.0;
  params.slave.force_sensor.noise_rms_N = 0.0;
  for (auto* chain : {&params.master.mechanism, &params.slave.mechanism}) {
    chain->motor.friction_N = 0.0;
    chain->drum.friction_N = 0.0;
    chain->linkage.hysteretic_fraction = 0.0;
  }
  // Soft and viscous, so that contact comes to rest although nothing rubs.
  params.environment.stiffness_N_per_m = 1000.0;
  params.environment.damping_N_s_per_m = 10.0;
  params.master.encoder.resolution_m = 0.0;
  params.slave.encoder.resolution_m = 0.0;
  return params;
}

Records press(const simulation::Teleoperator::Params& params, std::size_t ticks) {
  const mechanics::MinimumJerk reach{.start_m = -0.008, .end_m = 0.012, .start_time_s = 0.02, .duration_s = 0.5};
  auto teleoperator = simulation::Teleoperator::make(params, reach.start_m).value();
  Records records;
  for (std::size_t i = 0; i < ticks; ++i) {
    const double time_s = static_cast<double>(i) * teleoperator.tick_s();
    records.push_back(teleoperator.step(reach.position_m(time_s), reach.position_m(time_s + teleoperator.tick_s())));
  }
  EXPECT_TRUE(teleoperator.healthy());
  return records;
}

/// Long enough for hand and PD to come to rest.
constexpr std::size_t until_rest = 60000;

TEST(FourChannel, PressingAtRestTheHandPushesMuTimesTheContactForceAndTheSlaveStandsAtLambdaTimesTheMaster) {
  for (const double mu : {1.0, 3.0}) {
    for (const double lambda : {1.0, 0.5}) {
      simulation::Teleoperator::Params params = ideal_four_channel("four-channel");
      params.control.force_gain = mu;
      params.control.position_scale = lambda;
      // With the whole of the hand force on the slave the frictionless rig rings (docs/theory/four-channel.md).
      params.control.own<control::FourChannelParams>().slave_force_loop_gain = -0.5;
      params.control.own<control::FourChannelParams>().hand_force_gain = 0.5;
      const Records records = press(params, until_rest);
      const auto& end = records.back();
      ASSERT_GT(end.contact_force_N, 0.05);
      EXPECT_NEAR(end.hand_force_N, mu * end.contact_force_N, 1e-6) << "mu " << mu << ", lambda " << lambda;
      EXPECT_NEAR(end.displayed_force_N, end.hand_force_N, 1e-6);
      EXPECT_NEAR(end.slave_position_m, lambda * end.master_position_m, 1e-8);
    }
  }
}

// The slave of position-force needs an error to push: contact force over its proportional gain.
TEST(FourChannel, PositionForceLeavesTheErrorThatItsSlavesProportionalGainPushesWith) {
  simulation::Teleoperator::Params params = ideal_four_channel("position-force");
  params.control.cancellation = control::CancellationMode::off;
  params.control.force_gain = 1.0;
  const auto end = press(params, until_rest).back();
  EXPECT_NEAR(100.0 * (end.master_position_m - end.slave_position_m), end.contact_force_N, 1e-6);
  EXPECT_GT(end.contact_force_N, 0.05);
}

double largest_difference(const Records& a, const Records& b, double simulation::Teleoperator::Record::*value) {
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    most = std::max(most, std::fabs(a[i].*value - b[i].*value));
  return most;
}

TEST(FourChannelCancellation, OnTheNonlinearRigWithoutDelayTheSlaveMovesAsUnderTheCancellingMaster) {
  const auto run = [](const std::string& architecture, double delay_s) {
    simulation::Teleoperator::Params params = experiment_file<TappingParams>("tapping");
    params.control.architecture = architecture;
    params.channel.to_slave.delay_s = delay_s;
    return press(params, 5000);
  };
  const Records on_master = run("position-force", 0.0), on_slave = run("four-channel-cancellation", 0.0);
  // Contact makes and breaks on the way, which could pull apart what round-off separates.
  EXPECT_LT(largest_difference(on_master, on_slave, &simulation::Teleoperator::Record::tip_position_m), 1e-9);
  EXPECT_LT(largest_difference(on_master, on_slave, &simulation::Teleoperator::Record::displayed_force_N), 1e-5);
  EXPECT_GT(largest_difference(run("position-force", 5e-3), run("four-channel-cancellation", 5e-3),
                               &simulation::Teleoperator::Record::tip_position_m),
            1e-5);
}

}  // namespace four_channel_test
}  // namespace tactus::experiments
