// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

namespace tactus::simulation {
namespace teleoperator_test {

using Records = std::vector<Teleoperator::Record>;
using Path = std::function<double(double)>;

Teleoperator::Params tapping_params() { return experiment_file<experiments::TappingParams>("tapping"); }

/// The same without anything random or periodic: tremor, slow correction, noise.
Teleoperator::Params quiet_params() {
  Teleoperator::Params params = tapping_params();
  params.person.tremor_amplitude_m = 0.0;
  params.person.correction.gain_per_s = 0.0;
  params.slave.force_sensor.noise_rms_N = 0.0;
  return params;
}

/// The same with nothing that rubs, slips or counts, so that forces balance as on paper.
Teleoperator::Params ideal_params() {
  Teleoperator::Params params = quiet_params();
  for (auto* chain : {&params.master.mechanism, &params.slave.mechanism}) {
    chain->motor.friction_N = 0.0;
    chain->drum.friction_N = 0.0;
    chain->linkage.hysteretic_fraction = 0.0;
  }
  params.master.encoder.resolution_m = 0.0;
  params.slave.encoder.resolution_m = 0.0;
  return params;
}

/// A reach of 15 mm in 0.25 s after a rest of 20 ms, to 7 mm beyond the wall.
const mechanics::MinimumJerk tap{.start_m = -0.008, .end_m = 0.007, .start_time_s = 0.02, .duration_s = 0.25};
double tap_path(double time_s) { return tap.position_m(time_s); }

void advance(Teleoperator& teleoperator, const Path& path, std::size_t from, std::size_t ticks, Records& records) {
  for (std::size_t i = from; i < from + ticks; ++i) {
    const double time_s = static_cast<double>(i) * teleoperator.tick_s();
    records.push_back(teleoperator.step(path(time_s), path(time_s + teleoperator.tick_s())));
  }
}

Records run(const Teleoperator::Params& params, const Path& path = tap_path, std::size_t ticks = 2000) {
  auto teleoperator = Teleoperator::make(params, path(0.0));
  EXPECT_TRUE(teleoperator) << (teleoperator ? "" : describe(teleoperator.error()));
  Records records;
  advance(*teleoperator, path, 0, ticks, records);
  return records;
}

/// All that a record holds, bit by bit; padding has no say.
std::array<std::uint64_t, 13> bits(const Teleoperator::Record& record) {
  std::array<std::uint64_t, 13> words{};
  std::size_t i = 0;
  for (const double value :
       {record.time_s, record.master_position_m, record.induced_position_m, record.command_m, record.slave_position_m,
        record.tip_position_m, record.displayed_force_N, record.handle_force_N, record.hand_force_N,
        record.contact_force_N, record.peak_contact_force_N, record.touched_at_s}) {
    words[i++] = std::bit_cast<std::uint64_t>(value);
  }
  words[i] = record.touched ? 1 : 0;
  return words;
}

/// The first tick in which two runs differ.
std::size_t first_difference(const Records& a, const Records& b) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (bits(a[i]) != bits(b[i])) return i;
  }
  return std::numeric_limits<std::size_t>::max();
}
constexpr auto nowhere = std::numeric_limits<std::size_t>::max();

std::size_t first_touch(const Records& records) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].touched) return i;
  }
  ADD_FAILURE() << "the wall was never met";
  return 0;
}

TEST(Teleoperator, TwoRunsWithEqualInputAndSeedAreEqualBitForBit) {
  const Records once = run(tapping_params());
  EXPECT_LT(first_touch(once), once.size() / 2);
  EXPECT_EQ(first_difference(once, run(tapping_params())), nowhere);
}

TEST(Teleoperator, ACopyInTheMiddleOfAContactContinuesAsTheOriginal) {
  auto original = *Teleoperator::make(tapping_params(), tap_path(0.0));
  Records before;
  advance(original, tap_path, 0, 1000, before);
  ASSERT_LT(first_touch(before), 1000U);
  Teleoperator copy = original;
  Records of_original, of_copy;
  advance(original, tap_path, 1000, 500, of_original);
  // Were anything shared, the copy would go on from where the original is by now.
  advance(copy, tap_path, 1000, 500, of_copy);
  EXPECT_EQ(first_difference(of_original, of_copy), nowhere);
}

TEST(Teleoperator, AnotherSeedOfTheNoiseGivesAnotherRun) {
  Teleoperator::Params params = tapping_params();
  const Records one = run(params);
  params.slave.force_sensor.seed += 1;
  const Records other = run(params);
  EXPECT_LT(first_difference(one, other), 3U) << "the noise of the force sensor is displayed from the first tick on";
}

TEST(Teleoperator, ChannelDelayShiftsTheSlaveByExactlyThatManyTicks) {
  // Without a displayed force the master does not know of the slave, so a delay of the command is all there is.
  Teleoperator::Params params = quiet_params();
  params.control.force_gain = 0.0;
  const Records prompt = run(params);
  for (const auto& [delay_s, ticks] : {std::pair{0.005, 25U}, std::pair{0.00055, 3U}, std::pair{0.00009, 0U}}) {
    params.channel.to_slave.delay_s = delay_s;
    const Records late = run(params);
    for (std::size_t i = 0; i + ticks < late.size(); ++i) {
      ASSERT_NEAR(late[i + ticks].tip_position_m, prompt[i].tip_position_m, 1e-12) << i << " " << delay_s;
      ASSERT_EQ(late[i].master_position_m, prompt[i].master_position_m) << i;
    }
  }
}

TEST(Teleoperator, ChannelDelayOfTheForceLetsTheMasterFeelTheWallExactlyThatManyTicksLater) {
  Teleoperator::Params params = quiet_params();
  const auto first_displayed = [](const Records& records) {
    std::size_t i = 0;
    while (i < records.size() && records[i].displayed_force_N == 0.0) ++i;
    return i;
  };
  const Records prompt = run(params);
  const std::size_t felt = first_displayed(prompt);
  // Touched between ticks i and i + 1, measured at i + 1, displayed at i + 2.
  EXPECT_EQ(felt, first_touch(prompt) + 2);
  params.channel.to_master.delay_s = 0.004;
  const Records late = run(params);
  EXPECT_EQ(first_displayed(late), felt + 20);
  EXPECT_EQ(first_touch(late), first_touch(prompt));
}

TEST(Teleoperator, ComputationDelayLetsACommandActThatMuchLater) {
  // Both runs are the same until the first force is displayed, and the master's motor then moves later by the delay.
  Teleoperator::Params params = quiet_params();
  params.master.encoder.resolution_m = 0.0;
  params.servo.computation_delay_s = 0.0;
  const Records prompt = run(params);
  params.servo.computation_delay_s = 100e-6;
  const Records late = run(params);
  std::size_t moved = 0;
  while (moved < prompt.size() && prompt[moved].displayed_force_N == 0.0) ++moved;
  ASSERT_LT(moved + 1, prompt.size());
  // The slave's command is late too, so the first command of either site that is not nothing tells them apart.
  EXPECT_LE(first_difference(prompt, late), moved + 1);
  EXPECT_GT(first_difference(prompt, late), 50U) << "nothing moves while the person rests";
}

TEST(Teleoperator, WithoutADisplayedForceCancellationChangesNothing) {
  Teleoperator::Params params = tapping_params();
  params.control.force_gain = 0.0;
  params.control.cancellation = control::CancellationMode::off;
  const Records off = run(params);
  params.control.cancellation = control::CancellationMode::on;
  const Records on = run(params);
  EXPECT_LT(first_touch(on), on.size() / 2);
  EXPECT_EQ(first_difference(off, on), nowhere);
}

TEST(Teleoperator, WithADisplayedForceCancellationChangesTheCommandOnlyFromTheFirstForceOn) {
  Teleoperator::Params params = quiet_params();
  params.control.cancellation = control::CancellationMode::off;
  const Records off = run(params);
  params.control.cancellation = control::CancellationMode::on;
  const std::size_t differs = first_difference(off, run(params));
  // Displayed at touch + 2, in the motor's position at touch + 3.
  EXPECT_EQ(differs, first_touch(off) + 3);
}

TEST(Teleoperator, PressingStaticallyBalancesPositionControlWallAndHand) {
  Teleoperator::Params params = ideal_params();
  params.control.cancellation = control::CancellationMode::off;
  params.control.force_gain = 0.5;
  // Without friction the slave would chatter on the wall for ever; damping has no part in the balance.
  params.master.mechanism.linkage.damping_N_s_per_m = 2.0;
  params.slave.mechanism.linkage.damping_N_s_per_m = 2.0;
  const double pressed_m = 0.010;
  // Slow, so that nothing bounces, and then still for ten time constants of the hand, 23 N s/m over 40 N/m each.
  const mechanics::MinimumJerk press{.start_m = -0.002, .end_m = pressed_m, .start_time_s = 0.0, .duration_s = 0.4};
  const Records records = run(
      params, [&](double t) { return press.position_m(t); }, 30000);
  const Teleoperator::Record& end = records.back();

  // Springs in a row between the person's aim and the wall, seen by the force F at the tip. The hand and the master's
  // own elasticity carry half of F, because half of it is displayed.
  const double slave =
      1.0 / params.control.slave.proportional_N_per_m + 1.0 / params.slave.mechanism.cable.stiffness_N_per_m +
      1.0 / params.slave.mechanism.linkage.stiffness_N_per_m + 1.0 / params.environment.stiffness_N_per_m;
  const double master = 1.0 / params.person.grip.stiffness_N_per_m +
                        1.0 / params.master.mechanism.linkage.stiffness_N_per_m +
                        1.0 / params.master.mechanism.cable.stiffness_N_per_m;
  const double force_N = pressed_m / (slave + 0.5 * master);
  EXPECT_NEAR(end.contact_force_N, force_N, 1e-3 * force_N);
  EXPECT_NEAR(end.displayed_force_N, 0.5 * force_N, 1e-3 * force_N);
  EXPECT_NEAR(end.tip_position_m, force_N / params.environment.stiffness_N_per_m, 1e-8);
  EXPECT_NEAR(end.master_position_m, pressed_m - 0.5 * force_N * master, 1e-5);
  EXPECT_EQ(end.command_m, end.master_position_m);
}

TEST(Teleoperator, TheDisplayedForceIsTheTipForceTimesTheGainUpToItsLimit) {
  Teleoperator::Params params = quiet_params();
  params.control.force_gain = 3.0;
  params.control.force_limit_N = 0.6;
  const Records records = run(params, tap_path, 6000);
  double largest = 0.0;
  for (const auto& record : records) largest = std::max(largest, std::fabs(record.displayed_force_N));
  EXPECT_EQ(largest, 0.6);
  // Long after the impact: the mean of the sensor follows the mean of the contact.
  const auto mean_of_last = [&](auto&& value) {
    double sum = 0.0;
    for (std::size_t i = records.size() - 500; i < records.size(); ++i) sum += value(records[i]);
    return sum / 500.0;
  };
  const double contact_N = mean_of_last([](const auto& record) { return record.contact_force_N; });
  ASSERT_GT(contact_N, 0.05);
  const double displayed_N = mean_of_last([](const auto& record) { return record.displayed_force_N; });
  EXPECT_NEAR(displayed_N, std::min(0.6, 3.0 * contact_N), 0.01);
}

TEST(Teleoperator, ThePositionScaleScalesTheSlavesStartAndItsMotion) {
  Teleoperator::Params params = ideal_params();
  params.environment.position_m = 0.5;  // out of reach
  for (const double scale : {0.25, 2.0}) {
    params.control.position_scale = scale;
    const Records records = run(params, tap_path, 30000);
    EXPECT_DOUBLE_EQ(records.front().tip_position_m, scale * tap.start_m);
    EXPECT_DOUBLE_EQ(records.back().command_m, scale * records.back().master_position_m);
    EXPECT_NEAR(records.back().master_position_m, tap.end_m, 1e-6);
    EXPECT_NEAR(records.back().tip_position_m, scale * tap.end_m, 1e-6);
  }
}

TEST(Teleoperator, ASlaveThatStartsAtRestGetsNoKick) {
  Teleoperator::Params params = quiet_params();
  params.control.position_scale = 0.7;
  // Between two counts of the encoders.
  const double start_m = -0.0123456;
  const Records records = run(
      params, [&](double) { return start_m; }, 1000);
  for (const auto& record : records) {
    ASSERT_NEAR(record.tip_position_m, 0.7 * start_m, 1e-12);
    ASSERT_EQ(record.displayed_force_N, 0.0);
  }
}

TEST(Teleoperator, TheMeanContactForceHasTheImpulseThatTheForceSensorSaw) {
  // The sensor is an independent witness: it filters the force of every substep, and a filter keeps the impulse.
  Teleoperator::Params params = quiet_params();
  params.control.force_gain = 1.0;
  params.control.force_limit_N = 100.0;
  params.control.cancellation = control::CancellationMode::on;
  const Records records = run(params, tap_path, 4000);
  double of_contact = 0.0, of_sensor = 0.0;
  for (std::size_t i = 0; i + 2 < records.size(); ++i) {
    of_contact += records[i].contact_force_N;
    of_sensor += records[i + 2].displayed_force_N;
    ASSERT_GE(records[i].contact_force_N, 0.0);
    ASSERT_GE(records[i].peak_contact_force_N, records[i].contact_force_N);
  }
  EXPECT_NEAR(of_sensor / of_contact, 1.0, 0.01);
}

TEST(Teleoperator, NamesTheKeyThatCannotBe) {
  const auto refused_key = [](auto&& change) {
    Teleoperator::Params params = tapping_params();
    change(params);
    const auto teleoperator = Teleoperator::make(params, 0.0);
    return teleoperator ? std::string("was made") : teleoperator.error().parameter;
  };
  EXPECT_EQ(refused_key([](auto& p) { p.master.mechanism.motor.mass_kg = -1.0; }), "master.mechanism.motor.mass_kg");
  EXPECT_EQ(refused_key([](auto& p) { p.person.grip.stiffness_N_per_m = 1e12; }), "operator.grip.stiffness_N_per_m");
  EXPECT_EQ(refused_key([](auto& p) { p.environment.stiffness_N_per_m = std::nan(""); }),
            "environment.stiffness_N_per_m");
  EXPECT_EQ(refused_key([](auto& p) { p.environment.damping_N_s_per_m = 9999.0; }), "environment.damping_N_s_per_m");
  EXPECT_EQ(refused_key([](auto& p) { p.servo.computation_delay_s = 2e-4; }), "servo.computation_delay_s");
  EXPECT_EQ(refused_key([](auto& p) { p.control.slave.velocity.cutoff_Hz = 2400.0; }),
            "control.slave.velocity.cutoff_Hz");
  EXPECT_EQ(refused_key([](auto& p) {
              p.control.cancellation_step = control::CancellationStep::euler;
              p.control.model.cable.stiffness_N_per_m = 1e9;
            }),
            "control.cancellation_step");
  EXPECT_EQ(refused_key([](auto& p) { p.channel.to_slave.delay_s = 2.0; }), "channel.to_slave.delay_s");
}

/// Powers of two, so that both ways to write a grip are the same number.
Teleoperator::Params lighter_grip(double start_s) {
  Teleoperator::Params params = tapping_params();
  params.person.grip_change = {.factor = 0.25, .start_s = start_s, .duration_s = 0.0};
  return params;
}

TEST(Teleoperator, AGripThatChangesAtTheStartIsAHandOfThatGrip) {
  Teleoperator::Params light = tapping_params();
  light.person.grip.stiffness_N_per_m *= 0.25;
  light.person.grip.damping_N_s_per_m *= 0.25;
  EXPECT_EQ(first_difference(run(light), run(lighter_grip(0.0))), nowhere);
}

TEST(Teleoperator, AGripThatChangesLaterIsTheOldOneUntilThen) {
  const std::size_t difference = first_difference(run(tapping_params()), run(lighter_grip(0.2)));
  EXPECT_GE(difference, 1000U);
  EXPECT_LT(difference, 1020U);
}

TEST(Teleoperator, AGripThatChangesGraduallyGoesFromOneToItsFactorAndIsHalfWayInTheMiddle) {
  const mechanics::Operator::GripChange change{.factor = 3.0, .start_s = 0.5, .duration_s = 0.2};
  EXPECT_EQ(change.at(0.0), 1.0);
  EXPECT_EQ(change.at(0.5), 1.0);
  EXPECT_NEAR(change.at(0.6), 2.0, 1e-12);
  EXPECT_NEAR(change.at(0.7), 3.0, 1e-12);
  EXPECT_EQ(change.at(9.0), 3.0);
  for (double time_s = 0.5; time_s < 0.7; time_s += 0.01) EXPECT_LT(change.at(time_s), change.at(time_s + 0.01));
}

TEST(Teleoperator, RefusesAGripThatBecomesTooStiffForTheSteps) {
  Teleoperator::Params params = tapping_params();
  params.person.grip.stiffness_N_per_m = 5e7;
  ASSERT_TRUE(Teleoperator::make(params, 0.0));
  params.person.grip_change.factor = 20.0;
  const auto refused = Teleoperator::make(params, 0.0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "operator.grip.stiffness_N_per_m");
}

}  // namespace teleoperator_test
}  // namespace tactus::simulation
