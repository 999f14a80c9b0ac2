// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/doctor.hpp>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::runtime {
namespace {

/// A tree of files that stands for /proc and /sys of another machine.
class Machine : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(root_); }
  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << content;
  }
  [[nodiscard]] MachineFacts facts() const { return read_machine_facts(10, root_); }
  std::filesystem::path root_ = scratch_path();
};

/// A machine on which nothing is wrong.
MachineFacts sound() {
  MachineFacts facts;
  facts.real_time = {.what = "SCHED_FIFO priority 80", .held = true, .why = {}, .means = {}, .remedy = {}};
  facts.locked_limit_bytes = -1;
  facts.budget_us = 950'000;
  facts.budget_period_us = 1'000'000;
  facts.governors = {"performance"};
  facts.timer_resolution_ns = 1;
  facts.timer_slack_ns = 50'000;
  facts.clock_source = "tsc";
  facts.kernel = "6.1.0-rt";
  facts.preempt_rt = true;
  facts.cores = 4;
  return facts;
}

Measurement kept(std::int64_t late_ns, std::int64_t ticks = 10'000, std::int64_t missed = 0) {
  Measurement measurement;
  measurement.report.period_ns = 200'000;
  measurement.report.ticks = ticks;
  measurement.report.missed = missed;
  for (std::int64_t i = 0; i < ticks; ++i) measurement.report.lateness.add(late_ns);
  return measurement;
}

Fitness verdict_of(const std::string& name, const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    if (finding.name == name) return finding.verdict;
  }
  ADD_FAILURE() << "nothing is said of " << name;
  return Fitness::unknown;
}

TEST(Doctor, ASoundMachineIsGoodInEveryRespect) {
  for (const Finding& finding : diagnose(sound(), kept(10'000))) {
    EXPECT_EQ(finding.verdict, Fitness::good) << finding.name << ": " << finding.found;
    EXPECT_TRUE(finding.remedy.empty()) << finding.name;
    EXPECT_FALSE(finding.means.empty()) << finding.name;
  }
}

TEST(Doctor, EachFaultIsFoundWhereItIsAndNowhereElse) {
  struct Fault {
    const char* name;
    void (*put)(MachineFacts&);
    Fitness verdict;
  };
  const Fault faults[] = {
      {"scheduler",
       [](MachineFacts& f) {
         f.real_time = {.what = "SCHED_FIFO", .held = false, .why = "no", .means = "late", .remedy = "ulimit"};
       },
       Fitness::bad},
      {"budget of the control group", [](MachineFacts& f) { f.group_budget_us = 0; }, Fitness::bad},
      {"throttling", [](MachineFacts& f) { f.budget_us = 100'000; }, Fitness::bad},
      {"locked memory", [](MachineFacts& f) { f.locked_limit_bytes = 8 << 20; }, Fitness::poor},
      {"timer", [](MachineFacts& f) { f.timer_resolution_ns = 4'000'000; }, Fitness::bad},
      {"clock", [](MachineFacts& f) { f.clock_source = "hpet"; }, Fitness::poor},
      {"kernel", [](MachineFacts& f) { f.preempt_rt = false; }, Fitness::poor},
      {"sessions", [](MachineFacts& f) { f.autogroup = 1; }, Fitness::poor},
      {"frequency governor",
       [](MachineFacts& f) {
         f.governors = {"performance", "powersave"};
       },
       Fitness::poor},
      {"cores", [](MachineFacts& f) { f.cores = 1; }, Fitness::poor},
      {"hypervisor", [](MachineFacts& f) { f.hypervisor = true; }, Fitness::poor},
  };
  for (const Fault& fault : faults) {
    MachineFacts facts = sound();
    fault.put(facts);
    const auto findings = diagnose(facts, kept(10'000));
    for (const Finding& finding : findings) {
      const bool here = finding.name == fault.name;
      EXPECT_EQ(finding.verdict, here ? fault.verdict : Fitness::good) << fault.name << " at " << finding.name;
      EXPECT_EQ(finding.remedy.empty(), !here) << fault.name << " at " << finding.name;
    }
    EXPECT_EQ(can_keep_time(findings), fault.verdict != Fitness::bad) << fault.name;
  }
}

TEST(Doctor, AHypervisorThatTakesATwentiethOfTheTimeIsBad) {
  MachineFacts facts = sound();
  facts.hypervisor = true;
  Measurement measurement = kept(10'000);
  measurement.stolen_fraction = 0.2;
  EXPECT_EQ(verdict_of("hypervisor", diagnose(facts, measurement)), Fitness::bad);
}

TEST(Doctor, LatenessIsJudgedByTheTickAndByWhatWasMissed) {
  EXPECT_EQ(verdict_of("lateness", diagnose(sound(), kept(40'000))), Fitness::good);
  EXPECT_EQ(verdict_of("lateness", diagnose(sound(), kept(60'000))), Fitness::poor);
  EXPECT_EQ(verdict_of("lateness", diagnose(sound(), kept(10'000, 10'000, 5))), Fitness::poor);
  EXPECT_EQ(verdict_of("lateness", diagnose(sound(), kept(10'000, 10'000, 50))), Fitness::bad);
}

TEST(Doctor, WhatTheSystemDoesNotTellIsNoFault) {
  MachineFacts facts;
  facts.real_time = sound().real_time;
  facts.cores = 2;
  const auto findings = diagnose(facts, kept(10'000));
  EXPECT_TRUE(can_keep_time(findings));
  for (const char* name : {"throttling", "locked memory", "timer", "clock", "kernel", "frequency governor"}) {
    EXPECT_EQ(verdict_of(name, findings), Fitness::unknown) << name;
  }
}

TEST(Doctor, AMeasurementRunsAsLongAsAskedAndCountsEveryDeadline) {
  const auto measurement = measure_lateness({.rate_Hz = 1000.0, .priority = 10}, 0.2);
  ASSERT_TRUE(measurement);
  EXPECT_GE(measurement->report.ticks + measurement->report.missed, 200);
  EXPECT_EQ(measurement->report.late_ours(), 0);
}

TEST_F(Machine, FactsAreReadFromTheFilesOfTheKernel) {
  write("proc/self/cgroup", "9:name=systemd:/\n4:cpu,cpuacct:/user.slice/one\n0::/\n");
  write("sys/fs/cgroup/cpu,cpuacct/user.slice/one/cpu.rt_runtime_us", "0\n");
  write("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
  write("proc/sys/kernel/sched_rt_period_us", "1000000\n");
  write("proc/sys/kernel/sched_autogroup_enabled", "1\n");
  write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
  write("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance\n");
  write("sys/devices/system/cpu/isolated", "2-3\n");
  write("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n");
  write("sys/kernel/realtime", "1\n");
  write("proc/cpuinfo", "processor : 0\nflags : fpu hypervisor\n");
  const MachineFacts found = facts();
  EXPECT_EQ(found.group, "/user.slice/one");
  EXPECT_EQ(found.group_budget_us, 0);
  EXPECT_EQ(found.budget_us, -1);
  EXPECT_EQ(found.budget_period_us, 1'000'000);
  EXPECT_EQ(found.autogroup, 1);
  EXPECT_EQ(found.governors, (std::vector<std::string>{"performance", "powersave"}));
  EXPECT_EQ(found.isolated, "2-3");
  EXPECT_EQ(found.clock_source, "hpet");
  EXPECT_TRUE(found.preempt_rt);
  EXPECT_TRUE(found.hypervisor);
  EXPECT_GE(found.cores, 1);
}

TEST_F(Machine, AnEmptyTreeAndRubbishAreNotKnownAndNoCrash) {
  EXPECT_FALSE(facts().budget_us);
  EXPECT_TRUE(facts().governors.empty());
  EXPECT_FALSE(read_stolen(root_));
  write("proc/sys/kernel/sched_rt_runtime_us", "much\n");
  write("proc/self/cgroup", "cpu\n:\n\xff:cpu:\n");
  write("proc/stat", "cpu 1 2 3\n");
  EXPECT_FALSE(facts().budget_us);
  EXPECT_FALSE(facts().group_budget_us);
  EXPECT_FALSE(read_stolen(root_));
}

TEST_F(Machine, StolenTimeIsTheEighthColumn) {
  write("proc/stat", "cpu  100 20 30 400 5 6 7 80 9 9\ncpu0 1 2\n");
  const auto stolen = read_stolen(root_);
  ASSERT_TRUE(stolen);
  EXPECT_EQ(stolen->stolen, 80);
  EXPECT_EQ(stolen->total, 648);
}

}  // namespace
}  // namespace tactus::runtime
