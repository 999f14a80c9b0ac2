// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/servo_thread.hpp>

#include <atomic>
#include <chrono>
#include <csignal>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>

namespace tactus::runtime {
namespace {

using std::chrono::milliseconds;

ServoThreadParams at(double rate_Hz) { return {.rate_Hz = rate_Hz, .priority = 10}; }

/// Uses the processor, however long the system lets it wait for that.
void compute(std::int64_t wall_ns) noexcept {
  const std::int64_t end_ns = monotonic_ns() + wall_ns;
  while (monotonic_ns() < end_ns) {
  }
}

TEST(ServoThread, EveryTickBeginsAtOrAfterItsDeadlineAndDeadlinesLieOnOneGrid) {
  std::vector<station::Tick> ticks;
  ticks.reserve(200);
  const auto report = run_servo(at(2000.0), [&](const station::Tick& tick) noexcept {
    ticks.push_back(tick);
    return ticks.size() < 200;
  });
  ASSERT_TRUE(report);
  ASSERT_EQ(ticks.size(), 200U);
  EXPECT_EQ(report->ticks, 200);
  EXPECT_EQ(report->period_ns, 500'000);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    EXPECT_GE(ticks[i].began_ns, ticks[i].deadline_ns);
    EXPECT_EQ(ticks[i].deadline_ns - ticks[0].deadline_ns, 500'000 * (ticks[i].number - ticks[0].number));
    if (i > 0) {
      EXPECT_EQ(ticks[i].number, ticks[i - 1].number + 1 + ticks[i].missed);
    }
  }
  EXPECT_EQ(report->lateness.count(), 200);
}

TEST(ServoThread, AfterAStallTheNextDeadlineLiesInTheFutureAndNoStepCatchesUp) {
  std::vector<station::Tick> ticks;
  ticks.reserve(100);
  const auto report = run_servo(at(1000.0), [&](const station::Tick& tick) noexcept {
    ticks.push_back(tick);
    if (ticks.size() == 20) std::this_thread::sleep_for(milliseconds(20));
    return ticks.size() < 60;
  });
  ASSERT_TRUE(report);
  const station::Tick& stalled = ticks[19];
  const station::Tick& next = ticks[20];
  EXPECT_GE(next.missed, 19);
  EXPECT_GE(next.deadline_ns, stalled.began_ns + 20'000'000);
  EXPECT_GE(report->longest_gap, 19);
  std::int64_t missed = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    missed += ticks[i].missed;
    EXPECT_GT(ticks[i].deadline_ns, ticks[i - 1].began_ns) << "a burst at step " << i;
  }
  EXPECT_EQ(report->missed, missed + ticks[0].missed);
}

TEST(ServoThread, ALateTickOfAStepThatComputesTooLongIsOurs) {
  int steps = 0;
  const auto report = run_servo(at(1000.0), [&](const station::Tick&) noexcept {
    if (++steps % 10 == 0) compute(3'000'000);
    return steps < 100;
  });
  ASSERT_TRUE(report);
  // Others use this machine too, and may take a processor away from some of the ten.
  EXPECT_GE(report->late_for(station::LateCause::computing), 5);
  EXPECT_GE(report->late_ours(), 5);
  EXPECT_GE(report->missed, 10);
}

TEST(ServoThread, ALateTickOfAStepThatSleepsOrLocksIsOurs) {
  int steps = 0;
  const auto report = run_servo(at(1000.0), [&](const station::Tick&) noexcept {
    if (++steps % 10 == 0) std::this_thread::sleep_for(milliseconds(4));
    return steps < 100;
  });
  ASSERT_TRUE(report);
  EXPECT_GE(report->late_for(station::LateCause::blocking), 5);
  EXPECT_EQ(report->late_for(station::LateCause::computing), 0);
}

TEST(ServoThread, TheStepIsToldWhatBecameOfTheTickBefore) {
  std::vector<station::Tick> ticks;
  ticks.reserve(10);
  const auto report = run_servo(at(1000.0), [&](const station::Tick& tick) noexcept {
    ticks.push_back(tick);
    if (ticks.size() == 5) std::this_thread::sleep_for(milliseconds(3));
    return ticks.size() < 10;
  });
  ASSERT_TRUE(report);
  EXPECT_EQ(ticks[0].previous_duration_ns, 0);
  EXPECT_GE(ticks[5].previous_duration_ns, 3'000'000);
  EXPECT_NE(ticks[5].previous_cause, station::LateCause::none);
}

TEST(ServoThread, StopEndsItFromAnotherThread) {
  std::atomic<int> steps{0};
  auto count = [&](const station::Tick&) noexcept {
    steps.fetch_add(1);
    return true;
  };
  auto servo = ServoThread<decltype(count)>::start(at(1000.0), count);
  ASSERT_TRUE(servo);
  while (steps.load() < 5) std::this_thread::yield();
  EXPECT_FALSE((*servo)->ended());
  (*servo)->stop();
  const ServoReport& report = (*servo)->finish();
  EXPECT_TRUE((*servo)->ended());
  EXPECT_EQ(report.ticks, steps.load());
}

TEST(ServoThread, DenormalsAreFlushedOnItAndOnNoOtherThread) {
  volatile double smallest = std::numeric_limits<double>::min();
  double half = -1.0;
  ASSERT_TRUE(run_servo(at(1000.0), [&](const station::Tick&) noexcept {
    half = 0.5 * smallest;
    return false;
  }));
  EXPECT_EQ(half, 0.0);
  EXPECT_GT(0.5 * smallest, 0.0);
}

TEST(ServoThread, SignalsOfTheProcessGoToOtherThreads) {
  bool blocked = false;
  ASSERT_TRUE(run_servo(at(1000.0), [&](const station::Tick&) noexcept {
    sigset_t mask;
    pthread_sigmask(SIG_BLOCK, nullptr, &mask);
    blocked = sigismember(&mask, SIGTERM) == 1 && sigismember(&mask, SIGSEGV) == 0;
    return false;
  }));
  EXPECT_TRUE(blocked);
}

TEST(ServoThread, WhatIsNotGrantedSaysWhatIsLostAndHowToGetIt) {
  ServoThreadParams params = at(1000.0);
  params.core = 1023;  // no machine of ours has it
  const auto report = run_servo(params, [](const station::Tick&) noexcept { return false; });
  ASSERT_TRUE(report);
  EXPECT_EQ(report->ticks, 1);
  bool found = false;
  for (const Right& right : report->rights) {
    EXPECT_FALSE(right.what.empty());
    const bool explained = !right.why.empty() && !right.means.empty() && !right.remedy.empty();
    EXPECT_TRUE(right.held || explained) << right.what;
    found = found || (right.what == "core 1023" && !right.held);
  }
  EXPECT_TRUE(found);
}

TEST(ServoThread, TheLastPartOfTheWaitCanBeSpun) {
  ServoThreadParams params = at(1000.0);
  params.spin_s = 0.0003;
  int steps = 0;
  const auto report = run_servo(params, [&](const station::Tick&) noexcept { return ++steps < 100; });
  ASSERT_TRUE(report);
  EXPECT_EQ(report->late_for(station::LateCause::computing), 0) << "spinning is no work of the step";
}

TEST(ServoThread, SpinningMoreThanHalfATickIsRefusedByName) {
  ServoThreadParams params = at(5000.0);
  params.spin_s = 0.0002;
  const auto report = run_servo(params, [](const station::Tick&) noexcept { return false; });
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().parameter, "spin_s");
}

TEST(ServoThread, ParametersOutOfBoundsAreRefusedByName) {
  for (const double rate_Hz : {0.0, -1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    const auto report = run_servo(at(rate_Hz), [](const station::Tick&) noexcept { return false; });
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().parameter, "rate_Hz");
  }
}

constexpr std::int64_t period_ns = 200'000;

TEST(LateTicks, ATickThatEndsByTheNextDeadlineIsNotLate) {
  EXPECT_EQ(classify({.late_ns = 150'000, .duration_ns = 50'000, .own_ns = 50'000}, period_ns),
            station::LateCause::none);
}

TEST(LateTicks, AStepThatBeganLateIsTheMachinesAndALongOneIsJudgedByWhatItDid) {
  EXPECT_EQ(classify({.late_ns = 900'000, .duration_ns = 5'000, .own_ns = 5'000}, period_ns),
            station::LateCause::waking);
  const TickEvidence waited{.late_ns = 20'000, .duration_ns = 900'000, .own_ns = 5'000, .voluntary_switches = 1};
  EXPECT_EQ(classify(waited, period_ns), station::LateCause::stalled);
  TickEvidence tick = waited;
  tick.involuntary_switches = 1;
  EXPECT_EQ(classify(tick, period_ns), station::LateCause::preempted);
  tick = waited;
  tick.voluntary_switches = 2;
  EXPECT_EQ(classify(tick, period_ns), station::LateCause::blocking);
  tick = waited;
  tick.own_ns = 800'000;
  EXPECT_EQ(classify(tick, period_ns), station::LateCause::computing);
  tick = waited;
  tick.major_faults = 1;
  EXPECT_EQ(classify(tick, period_ns), station::LateCause::paging);
}

TEST(LateTicks, OursAndTheMachinesAddUpToAll) {
  ServoReport report;
  for (std::size_t i = 0; i < report.late.size(); ++i) report.late[i] = std::int64_t{1} << i;
  EXPECT_EQ(report.late_ours(), 2 + 4 + 8);
  EXPECT_EQ(report.late_machine(), 16 + 32 + 64);
}

}  // namespace
}  // namespace tactus::runtime
