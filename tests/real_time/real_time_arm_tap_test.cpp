// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/runtime/servo/rights.hpp>
#include <tactus/runtime/servo/site_log.hpp>
#include <tactus/runtime/servo/site_parts.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/real_time/real_time_arm_tap.hpp>
#include <tactus/simulation/real_time/replay.hpp>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/allocation_counter.hpp"
#include <gtest/gtest.h>
#include <tests/runtime/changed_log.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::real_time {
namespace {

using control::SiteRole;
using experiments::ArmRecord;
using experiments::ArmTaps;

/// Two taps of the experiment of the repository.
std::optional<ArmTaps> short_taps() {
  auto document = configuration::Document::load(TACTUS_EXPERIMENT_FOLDER "/arm-tapping.toml");
  if (!document || document->set("task.taps=2") || document->set("task.observation_s=0.25")) return std::nullopt;
  const auto params = document->read<experiments::ArmTappingParams>();
  if (!params) return std::nullopt;
  auto taps = ArmTaps::make(*params, TACTUS_EXPERIMENT_FOLDER);
  return taps ? std::optional(*std::move(taps)) : std::nullopt;
}

/// A tick at its deadline, as a clock that is never late gives it.
station::Tick arm_tick(std::int64_t number, std::int64_t missed = 0) {
  const std::int64_t deadline_ns = 1'000'000 * number;
  return {.number = number, .missed = missed, .deadline_ns = deadline_ns, .began_ns = deadline_ns};
}

std::vector<std::uint64_t> bits(const ArmRecord& record) {
  std::vector<std::uint64_t> all;
  for_each_signal<ArmRecord>(
      [&](const auto& signal) { all.push_back(std::bit_cast<std::uint64_t>(record.*signal.member)); });
  return all;
}

TEST(RealTimeArmTap, WithoutAMissedTickItIsBitForBitTheTapInVirtualTime) {
  const auto taps = short_taps();
  ASSERT_TRUE(taps);
  for (std::size_t tap = 0; tap < taps->size(); ++tap) {
    experiments::ArmTrace expected;
    const experiments::ArmTapResult result = taps->run(tap, &expected);
    auto real_time = RealTimeArmTap::make(taps->setup(), taps->tap(tap));
    ASSERT_TRUE(real_time);
    // The thread would count from anywhere.
    for (std::int64_t number = 17; real_time->step(arm_tick(number)); ++number) {
    }
    const auto& records = real_time->run().trace().records;
    ASSERT_EQ(records.size(), expected.records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
      ASSERT_EQ(bits(records[i]), bits(expected.records[i])) << "tick " << i;
    }
    EXPECT_TRUE(real_time->run().contact().touched);
    EXPECT_EQ(real_time->run().contact().peak_N, result.contact.peak_N);
    EXPECT_FALSE(real_time->run().diverged());
  }
}

TEST(RealTimeArmTap, WhileTicksAreMissedTheArmsGoOnAndTheSitesDoNot) {
  const auto taps = short_taps();
  ASSERT_TRUE(taps);
  ArmTapStreams streams(7);
  auto sites = streams.site(SiteRole::master).watch();
  auto tap = RealTimeArmTap::make(taps->setup(), taps->tap(0), &streams);
  ASSERT_TRUE(tap);
  constexpr std::int64_t before = 200, missed = 20;
  for (std::int64_t number = 0; number < before; ++number) ASSERT_TRUE(tap->step(arm_tick(number)));
  const ArmRecord last = tap->run().trace().records.back();
  ASSERT_TRUE(tap->step(arm_tick(before + missed, missed)));
  EXPECT_EQ(tap->run().trace().records.size(), before + missed + 1);
  EXPECT_GT(std::fabs(tap->run().trace().records.back().leader_m - last.leader_m), 1e-4) << "the arms stood still";
  runtime::JointStreams::Site::Entry entry;
  std::int64_t steps = 0, told_missed = 0;
  for (; sites.next(entry); ++steps) told_missed += entry.record.missed;
  EXPECT_EQ(steps, before + 1) << "no site has stepped in between";
  EXPECT_EQ(told_missed, missed);
}

TEST(RealTimeArmTap, ItLeavesWhatBothSitesHeardToldAndReadOfEachJoint) {
  const auto taps = short_taps();
  ASSERT_TRUE(taps);
  ArmTapStreams streams(7);
  auto master = streams.joint(SiteRole::master, 3).watch();
  auto slave = streams.joint(SiteRole::slave, 3).watch();
  auto site = streams.site(SiteRole::slave).watch();
  auto tap = RealTimeArmTap::make(taps->setup(), taps->tap(0), &streams);
  ASSERT_TRUE(tap);
  std::int64_t ticks = 1;
  while (tap->step(arm_tick(ticks - 1))) ++ticks;
  runtime::JointStreams::Joint::Entry of_master, of_slave;
  runtime::JointStreams::Site::Entry of_site;
  double slave_sent_N = 0.0, moved_rad = 0.0;
  for (std::int64_t number = 0; number < ticks; ++number) {
    ASSERT_TRUE(master.next(of_master));
    ASSERT_TRUE(slave.next(of_slave));
    ASSERT_TRUE(site.next(of_site));
    using Record = runtime::JointLogRecord;
    EXPECT_EQ(of_master.record.tick, number);
    EXPECT_EQ(of_slave.time_ns - of_master.time_ns, 0U);
    EXPECT_EQ(of_slave.record.Record::Received::position_m, of_master.record.Record::Sent::position_m);
    if (number > 0) {
      EXPECT_EQ(of_master.record.Record::Received::force_N, slave_sent_N) << "of the tick before";
    }
    slave_sent_N = of_slave.record.Record::Sent::force_N;
    moved_rad = std::fabs(of_slave.record.position_m - taps->setup().leader.start[3]);
    EXPECT_EQ(of_site.record.state, static_cast<std::int64_t>(control::SiteState::active));
    EXPECT_EQ(of_site.record.fault, 0);
  }
  EXPECT_NE(slave_sent_N, 0.0);
  EXPECT_GT(moved_rad, 1e-3);
}

TEST(RealTimeArmTap, ItsLogReplaysBitForBitTapAfterTap) {
  const auto taps = short_taps();
  ASSERT_TRUE(taps);
  const std::filesystem::path folder = scratch_path();
  ArmTapStreams streams(7);
  auto about = runtime::LogMetadata{{"tactus", {{"configuration", configuration::to_toml(taps->setup().params)}}}};
  about["urdf"] = runtime::urdfs_of(taps->setup());
  auto log = runtime::SiteLog::create(folder / "log", streams, about);
  ASSERT_TRUE(log) << describe(log.error());
  std::int64_t steps = 0;
  {
    const runtime::FlushedDenormals as_a_servo_thread;
    for (std::size_t tap = 0; tap < taps->size(); ++tap) {
      auto run = RealTimeArmTap::make(taps->setup(), taps->tap(tap), &streams);
      ASSERT_TRUE(run);
      // Some ticks are missed.
      for (std::int64_t number = 0, next = 0;; ++number) {
        const std::int64_t missed = number > 0 && number % 50 == 0 ? 2 : 0;
        next += missed;
        const bool more = run->step(arm_tick(next++, missed));
        ++steps;
        if (!more) break;
      }
    }
  }
  ASSERT_FALSE(log->close());
  ASSERT_EQ(log->dropped(), 0U);
  const auto replayed = replay(folder / "log");
  ASSERT_TRUE(replayed) << describe(replayed.error());
  EXPECT_EQ(replayed->of, std::to_string(taps->size()) + " taps of two arms");
  EXPECT_GE(replayed->ticks, steps - static_cast<std::int64_t>(taps->size()));
  EXPECT_FALSE(replayed->difference) << replayed->difference->topic << " " << replayed->difference->signal << " at "
                                     << replayed->difference->tick;
  const auto found = replay(runtime::tampered(folder / "log", "/slave/joint_5", "position_m", 700));
  ASSERT_TRUE(found) << describe(found.error());
  ASSERT_TRUE(found->difference);
  EXPECT_TRUE(found->difference->topic.starts_with("/slave/joint_")) << found->difference->topic;
  std::filesystem::remove_all(folder);
}

TEST(RealTimeArmTap, ATickDoesNotAllocate) {
  const auto taps = short_taps();
  ASSERT_TRUE(taps);
  ArmTapStreams streams(7);
  auto tap = RealTimeArmTap::make(taps->setup(), taps->tap(0), &streams);
  ASSERT_TRUE(tap);
  const std::uint64_t before = laws::own_allocation_count();
  for (std::int64_t number = 0; tap->step(arm_tick(number + number / 50, number % 50 == 0 && number > 0 ? 1 : 0));
       ++number) {
  }
  EXPECT_EQ(laws::own_allocation_count() - before, 0U);
  EXPECT_TRUE(tap->run().contact().touched);
}

}  // namespace
}  // namespace tactus::real_time
