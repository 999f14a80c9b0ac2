// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/contact_judge.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::live {
namespace {

constexpr double tick_s = 2e-4;

std::size_t ticks_in(double duration_s) { return static_cast<std::size_t>(std::lround(duration_s / tick_s)); }

/// A contact that begins at `begin` and presses with 0.5 N, with an oscillation of 60 Hz on it that fades with a time
/// constant.
std::vector<double> contact(std::size_t begin, std::size_t ticks, double fades_in_s) {
  std::vector<double> force_N(ticks, 0.0);
  for (std::size_t i = begin; i < ticks; ++i) {
    const double time_s = static_cast<double>(i - begin) * tick_s;
    const double ringing = std::exp(-time_s / fades_in_s) * std::sin(2.0 * std::numbers::pi * 60.0 * time_s);
    force_N[i] = std::max(0.001, 0.5 * (1.0 - std::exp(-time_s / 0.01)) + 0.4 * ringing);
  }
  return force_N;
}

TEST(ContactJudge, AgreesWithTheTappingExperimentOnWhetherAndWhenAContactSettles) {
  const std::size_t begin = 250;
  const std::size_t window = ticks_in(0.35);
  int settled = 0;
  for (const double fades_in_s : {0.004, 0.01, 0.02, 0.03, 0.036, 0.042, 0.06, 0.1, 0.5, 1e9}) {
    const std::vector<double> force_N = contact(begin, begin + window, fades_in_s);
    const auto whole = experiments::judge_contact(force_N, begin, tick_s);
    ContactJudge judge = ContactJudge::make(Seconds{tick_s}).value();
    LiveVerdict verdict = LiveVerdict::free;
    for (std::size_t i = 0; i < force_N.size(); ++i) {
      judge.step(force_N[i], i == begin);
      EXPECT_EQ(judge.has_begun(), i == begin);
      // The first verdict counts: after it, what rang may have become calm.
      if (verdict == LiveVerdict::free || verdict == LiveVerdict::contact) verdict = judge.verdict();
      if (verdict == LiveVerdict::settled && judge.verdict() == verdict) {
        EXPECT_NEAR(judge.settling_time_s(), whole.settling_time_s, 1e-9) << fades_in_s;
      }
    }
    const bool expected = whole.settled && whole.settling_time_s <= 0.1;
    EXPECT_EQ(verdict, expected ? LiveVerdict::settled : LiveVerdict::rings) << fades_in_s;
    settled += expected ? 1 : 0;
  }
  EXPECT_GT(settled, 2);
  EXPECT_LT(settled, 8);
}

TEST(ContactJudge, WhatRingsAndBecomesCalmIsSettledAgainAndTheContactIsForgottenAfterItsEnd) {
  std::vector<double> force_N = contact(100, ticks_in(2.0), 0.1);
  force_N.resize(force_N.size() + ticks_in(2.0), 0.0);
  ContactJudge judge = ContactJudge::make(Seconds{tick_s}).value();
  std::vector<LiveVerdict> verdicts;
  for (std::size_t i = 0; i < force_N.size(); ++i) {
    judge.step(force_N[i], i == 100);
    if (verdicts.empty() || verdicts.back() != judge.verdict()) verdicts.push_back(judge.verdict());
  }
  EXPECT_EQ(verdicts, (std::vector{LiveVerdict::free, LiveVerdict::contact, LiveVerdict::rings, LiveVerdict::settled,
                                   LiveVerdict::free}));
}

TEST(ContactJudge, TheVerdictEndsWithTheContact) {
  for (const double fades_in_s : {0.004, 1e9}) {
    ContactJudge judge = ContactJudge::make(Seconds{tick_s}).value();
    const std::vector<double> force_N = contact(0, ticks_in(0.5), fades_in_s);
    for (std::size_t i = 0; i < force_N.size(); ++i) judge.step(force_N[i], i == 0);
    const bool rings = judge.verdict() == LiveVerdict::rings;
    EXPECT_EQ(rings, fades_in_s > 1.0);
    for (std::size_t i = 0; i < ticks_in(rings ? 0.26 : 0.11); ++i) judge.step(0.0, false);
    EXPECT_EQ(judge.verdict(), LiveVerdict::free) << fades_in_s;
  }
}

TEST(ContactJudge, WhatLeavesTheWallBeforeItsVerdictHasNotSettledThere) {
  ContactJudge judge = ContactJudge::make(Seconds{tick_s}).value();
  for (std::size_t i = 0; i < ticks_in(0.24); ++i) {
    judge.step(i < ticks_in(0.01) ? 0.5 : 0.0, i == 0);
    EXPECT_EQ(judge.verdict(), LiveVerdict::contact) << i;
  }
}

TEST(ContactJudge, AContactThatGoesOnThroughAChangeIsJudgedFromThereOn) {
  ContactJudge judge = ContactJudge::make(Seconds{tick_s}).value();
  const std::vector<double> force_N = contact(0, ticks_in(0.5), 1e9);
  for (std::size_t i = 0; i < force_N.size(); ++i) judge.step(force_N[i], i == 0);
  EXPECT_EQ(judge.verdict(), LiveVerdict::rings);
  judge.judge_anew();
  judge.step(0.5, false);
  EXPECT_TRUE(judge.has_begun());
  EXPECT_EQ(judge.verdict(), LiveVerdict::contact);
  for (std::size_t i = 0; i < ticks_in(0.3); ++i) judge.step(0.5, false);
  EXPECT_EQ(judge.verdict(), LiveVerdict::settled);
}

TEST(ContactJudge, ATouchThatNobodyFeelsCountsAsCalm) {
  ContactJudge judge = ContactJudge::make(Seconds{tick_s}).value();
  signal::Random noise(3);
  for (std::size_t i = 0; i < ticks_in(0.3); ++i) judge.step(0.002 + 0.001 * noise.uniform(), i == 0);
  EXPECT_EQ(judge.verdict(), LiveVerdict::settled);
}

TEST(ContactJudge, AResetJudgeKnowsNothing) {
  ContactJudge judge = ContactJudge::make(Seconds{tick_s}).value();
  for (const double force_N : contact(0, 2000, 1e9)) judge.step(force_N, judge.verdict() == LiveVerdict::free);
  EXPECT_EQ(judge.verdict(), LiveVerdict::rings);
  EXPECT_FALSE(judge.cause().empty());
  judge.reset();
  judge.step(0.0, false);
  EXPECT_EQ(judge.verdict(), LiveVerdict::free);
  EXPECT_TRUE(judge.cause().empty());
}

}  // namespace
}  // namespace tactus::live
