// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>
#include <tactus/simulation/experiments/arm_faults/faulty_configuration.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace arm_faults_test {

const std::filesystem::path folder = TACTUS_EXPERIMENT_FOLDER;

ArmTappingParams arm_params() {
  auto document = configuration::Document::load(folder / "arm-tapping.toml").value();
  const auto limits = configuration::Document::load(folder / "arms/limits.toml").value();
  EXPECT_EQ(document.merge(limits), std::nullopt);
  return document.read<ArmTappingParams>().value();
}
ArmFaultBench arm_bench(std::int64_t seeds = 1, const std::string& only = {}) {
  ArmTappingParams params = arm_params();
  params.faults.seeds = seeds;
  params.faults.only = only;
  return make_arm_fault_bench(params, folder).value();
}
FaultRow arm_row(std::string_view id) { return arm_fault_rows(id).front(); }

/// A plan of a row, its begin and its place chosen.
FaultPlan arm_plan(const ArmFaultBench& bench, std::string_view id, std::int64_t index, FaultSite site) {
  FaultPlan plan = draw_arm_plan(arm_row(id).kind, index, 1, bench.setup.params.rig.leader_gate,
                                 bench.setup.params.servo.rate_Hz, bench.wired_s());
  plan.site = site;
  return plan;
}

TEST(FaultsOfArms, PlansDependOnTheirSeedAloneAndReachEveryJoint) {
  const ArmTappingParams params = arm_params();
  std::set<std::size_t> joints;
  for (std::int64_t i = 0; i < 60; ++i) {
    const FaultPlan plan = draw_arm_plan(FaultKind::encoder_spike, i, 1, params.rig.leader_gate, 1000.0, 5.0);
    const FaultPlan again = draw_arm_plan(FaultKind::encoder_spike, i, 1, params.rig.leader_gate, 1000.0, 5.0);
    EXPECT_EQ(plan.size, again.size);
    EXPECT_EQ(plan.start_s, again.start_s);
    EXPECT_GE(std::fabs(plan.size), 2.0 * params.rig.leader_gate.encoder.fastest_m_per_s / 1000.0);
    joints.insert(joint_of_plan(plan, 7));
  }
  EXPECT_EQ(joints.size(), 7U);
}

TEST(FaultsOfArms, EqualPlansHaveEqualOutcomes) {
  const ArmFaultBench bench = arm_bench();
  const FaultPlan plan = arm_plan(bench, "cut", 0, FaultSite::master);
  const FaultOutcome one = run_arm_fault(bench, plan), other = run_arm_fault(bench, plan);
  EXPECT_EQ(one.peak_force_N, other.peak_force_N);
  EXPECT_EQ(one.master.peak_force_N, other.master.peak_force_N);
  EXPECT_EQ(one.slave.given_J, other.slave.given_J);
  EXPECT_GT(one.slave.peak_force_N, 0.0) << "the tool touches";
}

TEST(FaultsOfArms, MotorsThatAreSoundPassTheirTrialAndAreFollowed) {
  const ArmFaultBench bench = arm_bench();
  const FaultPlan plan{.kind = FaultKind::none, .start_s = 0.0, .length_s = bench.wired_s(), .impairment = {}};
  EXPECT_TRUE(run_arm_fault(bench, plan).active_in_fault);
}

/// What a witness must see where it is there, and what a rule says of it.
TEST(FaultsOfArms, TheJudgeNamesWhatWasBroken) {
  const ArmFaultBench bench = arm_bench();
  const ArmTappingParams& params = bench.setup.params;
  const FaultPlan plan = arm_plan(bench, "cut", 0, FaultSite::master);
  FaultOutcome good{.became_active = true, .stopped = true, .time_to_stop_s = 0.1, .active_at_end = true};
  good.arms.emplace();
  const auto rule = [&](auto&& spoil) {
    FaultOutcome bad = good;
    spoil(bad);
    return broken_arm_rule(arm_row("cut"), plan, bad, params);
  };
  EXPECT_EQ(rule([](FaultOutcome&) {}), "");
  EXPECT_EQ(rule([](FaultOutcome& bad) { bad.arms->fastest_joint_share = 1.26; }),
            "a joint faster than its gate lets it be");
  EXPECT_EQ(rule([](FaultOutcome& bad) { bad.arms->sank_m = 0.03; }), "an arm sank that was to be carried");
  EXPECT_EQ(rule([](FaultOutcome& bad) { bad.became_active = false; }), "did not follow before");
  EXPECT_EQ(rule([](FaultOutcome& bad) { bad.slave.peak_force_N = 281.0; }), "too much force at the tool");
  FaultPlan wired = arm_plan(bench, "motor-reversed", 0, FaultSite::slave);
  FaultOutcome followed = good;
  followed.active_in_fault = true;
  EXPECT_EQ(broken_arm_rule(arm_row("motor-reversed"), wired, followed, params),
            "followed though a joint was wired wrongly");
}

TEST(FaultsOfArms, ALongCutEndsInHoldAndAWatchdogThatWaitsTooLongBreaksThatDuty) {
  ArmFaultBench bench = arm_bench();
  FaultPlan plan = arm_plan(bench, "cut", 0, FaultSite::master);
  plan.length_s = 0.5;
  const ArmTappingParams promised = bench.setup.params;
  EXPECT_EQ(broken_arm_rule(arm_row("cut"), plan, run_arm_fault(bench, plan), promised), "");
  bench.setup.params.rig.supervision.watchdog.timeout_s = 2.0;
  EXPECT_EQ(broken_arm_rule(arm_row("cut"), plan, run_arm_fault(bench, plan), promised),
            "not stopped within the time-out");
}

TEST(FaultsOfArms, AMotorThatIsWiredWronglyIsNotFollowed) {
  const ArmFaultBench bench = arm_bench();
  const FaultPlan tried = arm_plan(bench, "motor-reversed", 0, FaultSite::slave);
  EXPECT_FALSE(run_arm_fault(bench, tried).active_in_fault);
}

/// The control of the watch of the motors: without it the same plans break a bound.
TEST(FaultsOfArms, AMotorThatIsReversedWhileItFollowsIsReleasedByTheWatchOfTheMotorsAlone) {
  ArmTappingParams params = arm_params();
  const FaultRow row = arm_row("motor-reversed");
  for (const double deviations : {params.rig.motor_watch.deviations, 0.0}) {
    params.rig.motor_watch.deviations = deviations;
    const ArmFaultBench bench = make_arm_fault_bench(params, folder).value();
    for (const std::int64_t index : {3, 13}) {
      const FaultPlan plan = draw_arm_plan(row, bench, index);
      const std::string_view rule = broken_arm_rule(row, plan, run_arm_fault(bench, plan), params);
      EXPECT_EQ(rule.empty(), deviations > 0.0) << index << ": " << rule;
    }
  }
}

/// The control of the judgement of gravity compensation: without it the same plan breaks a bound.
TEST(FaultsOfArms, AModelThatOverstatesTheWeightIsReleasedBeforeAJointLeaps) {
  ArmTappingParams params = arm_params();
  const FaultRow row = arm_row("model-wrong");
  const auto rule_of = [&](std::int64_t index) {
    const ArmFaultBench bench = make_arm_fault_bench(params, folder).value();
    return broken_arm_rule(row, draw_arm_plan(row, bench, index),
                           run_arm_fault(bench, draw_arm_plan(row, bench, index)), params);
  };
  constexpr std::int64_t masses = 0, lengths = 5;
  EXPECT_EQ(rule_of(masses), "");
  EXPECT_EQ(rule_of(lengths), "");
  params.rig.support.raise_s = 0.0;
  EXPECT_NE(rule_of(masses), "");
}

/// The control of the comparison: sites that are told that they agree are armed with the same plans.
TEST(FaultsOfArms, SitesThatDifferAreNotArmedAndNameTheKeyWithBothValues) {
  const ArmFaultBench bench = arm_bench();
  const FaultRow row = arm_row("configurations-differ");
  for (std::size_t key = 0; key < FaultyArmConfiguration::keys.size(); ++key) {
    FaultPlan plan = draw_arm_plan(row, bench, static_cast<std::int64_t>(key));
    const FaultOutcome differs = run_arm_fault(bench, plan);
    EXPECT_EQ(broken_arm_rule(row, plan, differs, bench.setup.params), "") << FaultyArmConfiguration::keys[key];
    EXPECT_TRUE(differs.arms->named) << FaultyArmConfiguration::keys[key];
    if (key > 1) continue;
    plan.size = 1.0;
    EXPECT_EQ(broken_arm_rule(row, plan, run_arm_fault(bench, plan), bench.setup.params),
              "armed although the sites differ")
        << FaultyArmConfiguration::keys[key];
  }
}

TEST(FaultsOfArms, LimitsThatNobodyChoseAreRefusedByName) {
  const ArmTappingParams wide =
      configuration::Document::load(folder / "arm-tapping.toml").value().read<ArmTappingParams>().value();
  const auto bench = make_arm_fault_bench(wide, folder);
  ASSERT_FALSE(bench);
  EXPECT_NE(describe(bench.error()).find("rig.leader_gate.force_limit_N"), std::string::npos)
      << describe(bench.error());
}

TEST(FaultsOfArms, AnUnknownRowIsRefusedWithTheIdsThatThereAre) {
  const auto table = run_arm_faults(arm_bench(1, "encoder-spice"), [](double) {});
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().parameter, "faults.only");
  EXPECT_NE(table.error().message.find("encoder-spike"), std::string::npos);
}

/// The quick form: every row, a few plans of each.
TEST(FaultsOfArms, AreSurvived) {
  const ArmFaultBench bench = arm_bench(2);
  const FaultTable table = run_arm_faults(bench, [](double) {}).value();
  EXPECT_EQ(table.rows.size(), arm_fault_rows().size());
  for (const FaultTally& row : table.rows) {
    EXPECT_EQ(row.worst.not_finite + row.worst.stale_applied + row.worst.active_without_arming, 0) << row.row.id;
    EXPECT_EQ(row.worst.steps_above_rate + row.worst.forces_above_limit, 0) << row.row.id;
    EXPECT_LE(row.worst.slave.peak_force_N, bench.setup.params.faults.bounds.tool_force_N) << row.row.id;
    EXPECT_LE(row.worst.master.peak_force_N, bench.setup.params.faults.bounds.hand_force_N) << row.row.id;
    for (const FaultFailure& failure : row.failures) {
      ADD_FAILURE() << row.row.id << " number " << failure.number << ": " << failure.rule;
    }
  }
}

}  // namespace arm_faults_test
}  // namespace tactus::experiments
