// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/projection.hpp>
#include <tactus/kernel/control/architectures/shared_compliant.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

/// Position-position, projection and shared-compliant in the loop: person, devices, channel and wall.
namespace tactus::experiments {
namespace couplings_test {

using Records = std::vector<simulation::Teleoperator::Record>;

simulation::Teleoperator::Params tapping_params(const std::string& architecture) {
  simulation::Teleoperator::Params params = experiment_file<TappingParams>("tapping");
  params.control.architecture = architecture;
  return params;
}

/// The same without tremor, correction, noise, friction, hysteresis and encoder counts, so that forces balance as on
/// paper, and damped so that a slave without friction does not chatter.
simulation::Teleoperator::Params ideal_coupling(const std::string& architecture) {
  simulation::Teleoperator::Params params = tapping_params(architecture);
  params.control.cancellation = control::CancellationMode::off;
  params.person.tremor_amplitude_m = 0.0;
  params.person.correction.gain_per_s = 0.0;
  params.slave.force_sensor.noise_rms_N = 0.0;
  for (auto* chain : {&params.master.mechanism, &params.slave.mechanism}) {
    chain->motor.friction_N = 0.0;
    chain->drum.friction_N = 0.0;
    chain->linkage.hysteretic_fraction = 0.0;
    chain->linkage.damping_N_s_per_m = 2.0;
  }
  params.master.encoder.resolution_m = 0.0;
  params.slave.encoder.resolution_m = 0.0;
  return params;
}

Records run(const simulation::Teleoperator::Params& params, const mechanics::MinimumJerk& reach, std::size_t ticks) {
  simulation::Teleoperator teleoperator = simulation::Teleoperator::make(params, reach.position_m(0.0)).value();
  Records records;
  for (std::size_t i = 0; i < ticks; ++i) {
    const double time_s = static_cast<double>(i) * teleoperator.tick_s();
    records.push_back(teleoperator.step(reach.position_m(time_s), reach.position_m(time_s + teleoperator.tick_s())));
  }
  EXPECT_TRUE(teleoperator.healthy());
  return records;
}

const mechanics::MinimumJerk tap{.start_m = -0.008, .end_m = 0.007, .start_time_s = 0.02, .duration_s = 0.25};

class Couplings : public ::testing::TestWithParam<const char*> {};

TEST_P(Couplings, StayFiniteAndWithinTheForceLimitOverAnyChannelAndFeelTheWall) {
  const station::Channel::Params channels[] = {{.delay_s = 0.0},
                                               {.delay_s = 0.02},
                                               {.delay_s = 0.005, .jitter_s = 0.01},
                                               {.delay_s = 0.002, .jitter_s = 0.004, .loss_fraction = 0.3}};
  for (const station::Channel::Params& channel : channels) {
    for (const double gain : {1.0, 10.0}) {
      for (const auto mode : {control::CancellationMode::off, control::CancellationMode::on}) {
        simulation::Teleoperator::Params params = tapping_params(GetParam());
        params.control.force_gain = gain;
        params.control.force_limit_N = 0.8;
        params.control.cancellation = mode;
        params.channel.to_slave = channel;
        params.channel.to_master = channel;
        params.channel.to_master.seed = 2;
        double most_N = 0.0, deepest_N = 0.0;
        for (const simulation::Teleoperator::Record& record : run(params, tap, 4000)) {
          ASSERT_TRUE(std::isfinite(record.master_position_m) && std::isfinite(record.slave_position_m) &&
                      std::isfinite(record.command_m) && std::isfinite(record.contact_force_N));
          ASSERT_LE(std::fabs(record.displayed_force_N), 0.8 * (1.0 + 1e-12));
          ASSERT_LE(std::fabs(record.tip_position_m), 0.1);
          most_N = std::max(most_N, record.displayed_force_N);
          deepest_N = std::max(deepest_N, record.contact_force_N);
        }
        EXPECT_GT(deepest_N, 0.1);
        EXPECT_GT(most_N, 0.1);
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Architectures, Couplings,
                         ::testing::Values("position-position", "projection", "shared-compliant"));

/// Compliances in m/N between the person's aim and the wall: of the slave and wall, of the master and grip, and of the
/// part of the master between the motor and the aim alone.
struct Balance {
  double slave, master;
  explicit Balance(const simulation::Teleoperator::Params& p)
      : slave(1.0 / p.control.slave.proportional_N_per_m + 1.0 / p.slave.mechanism.cable.stiffness_N_per_m +
              1.0 / p.slave.mechanism.linkage.stiffness_N_per_m + 1.0 / p.environment.stiffness_N_per_m),
        master(1.0 / p.person.grip.stiffness_N_per_m + 1.0 / p.master.mechanism.linkage.stiffness_N_per_m +
               1.0 / p.master.mechanism.cable.stiffness_N_per_m) {}
};

constexpr double pressed_m = 0.010;
constexpr double gain = 0.5;

/// Slow, so that nothing bounces, and then still for ten time constants of the hand, 23 N s/m over 40 N/m each.
simulation::Teleoperator::Record pressed(simulation::Teleoperator::Params params) {
  params.control.force_gain = gain;
  return run(params, {.start_m = -0.002, .end_m = pressed_m, .start_time_s = 0.0, .duration_s = 0.4}, 30000).back();
}

TEST(Couplings, APressOverPositionPositionShowsTheForceOfTheContactWithoutASensorForIt) {
  const simulation::Teleoperator::Params params = ideal_coupling("position-position");
  const Balance balance(params);
  const double force_N = pressed_m / (balance.slave + gain * balance.master);
  const simulation::Teleoperator::Record end = pressed(params);
  EXPECT_NEAR(end.contact_force_N, force_N, 1e-3 * force_N);
  EXPECT_NEAR(end.displayed_force_N, gain * force_N, 1e-3 * force_N);
}

TEST(Couplings, APressOverProjectionShowsAllOfTheForceAtRest) {
  const simulation::Teleoperator::Params params = ideal_coupling("projection");
  const Balance balance(params);
  const double force_N = pressed_m / (balance.slave + gain * balance.master);
  const simulation::Teleoperator::Record end = pressed(params);
  EXPECT_NEAR(end.contact_force_N, force_N, 1e-3 * force_N);
  EXPECT_NEAR(end.displayed_force_N, gain * force_N, 1e-3 * force_N);
}

TEST(Couplings, APressOverASharedCompliantSlaveMeetsItsStiffnessInRow) {
  simulation::Teleoperator::Params params = ideal_coupling("shared-compliant");
  for (const double stiffness : {100.0, 500.0}) {
    params.control.own<control::ComplianceParams>().stiffness_N_per_m = stiffness;
    const Balance balance(params);
    const double force_N = pressed_m / (balance.slave + 1.0 / stiffness + gain * balance.master);
    const simulation::Teleoperator::Record end = pressed(params);
    EXPECT_NEAR(end.contact_force_N, force_N, 1e-3 * force_N) << stiffness;
    EXPECT_NEAR(end.displayed_force_N, gain * force_N, 1e-3 * force_N) << stiffness;
  }
}

TEST(Couplings, FreeMotionOverPositionPositionDragsByTheRoundTripTimesTheStiffness) {
  simulation::Teleoperator::Params params = ideal_coupling("position-position");
  params.control.force_gain = gain;
  params.environment.position_m = 0.5;  // out of reach
  params.channel.to_slave.delay_s = 0.02;
  params.channel.to_master.delay_s = 0.01;
  // Looked at half-way, where the speed is largest and nothing accelerates.
  const mechanics::MinimumJerk reach{.start_m = 0.0, .end_m = 0.4, .start_time_s = 0.0, .duration_s = 5.0};
  const Records records = run(params, reach, 12700);
  const double speed_m_per_s = (records[12600].master_position_m - records[12500].master_position_m) / (100 * 200e-6);
  EXPECT_NEAR(speed_m_per_s, 1.875 * 0.4 / 5.0, 0.01);
  const double round_trip_s = 0.03 + 200e-6;  // on one computer a tick more on the way to the master
  const double expected_N = gain * params.control.slave.proportional_N_per_m * speed_m_per_s * round_trip_s;
  EXPECT_NEAR(records[12550].displayed_force_N, expected_N, 0.01 * expected_N);
}

/// Impulse in N s that was displayed in the first 5 ms after the tip met the wall.
double impact_shown_N_s(const simulation::Teleoperator::Params& params) {
  const Records records = run(params, tap, 2000);
  const auto touch = std::find_if(records.begin(), records.end(), [](const auto& record) { return record.touched; });
  double shown_N_s = 0.0;
  for (auto record = touch; record < touch + 25; ++record) shown_N_s += 200e-6 * record->displayed_force_N;
  return shown_N_s;
}

TEST(Couplings, OfAnImpactProjectionShowsTheUnconditionalFractionAndWhatTheHandHeldBefore) {
  simulation::Teleoperator::Params params = tapping_params("position-force");
  params.person.tremor_amplitude_m = 0.0;
  params.control.force_gain = 1.0;
  const double whole_N_s = impact_shown_N_s(params);
  params.control.architecture = "projection";
  params.control.own<control::ProjectionParams>().unconditional_fraction = 1.0;
  EXPECT_NEAR(impact_shown_N_s(params) / whole_N_s, 1.0, 1e-12);
  for (const double fraction : {0.05, 0.1, 0.3}) {
    params.control.own<control::ProjectionParams>().unconditional_fraction = fraction;
    const double share = impact_shown_N_s(params) / whole_N_s;
    EXPECT_GT(share, fraction);
    EXPECT_LT(share, fraction + 0.04);
  }
}

}  // namespace couplings_test
}  // namespace tactus::experiments
