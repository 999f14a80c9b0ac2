// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/runtime/servo/rights.hpp>
#include <tactus/runtime/servo/site_log.hpp>
#include <tactus/runtime/servo/site_parts.hpp>
#include <tactus/simulation/real_time/replay.hpp>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <tests/devices/rig/arms_bench.hpp>
#include <tests/runtime/changed_log.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::devices {
namespace rig_arms_test {

using real_time::replay;
using runtime::changed_log;
using runtime::tampered;

/// The arms of the bench leave a log, through all that changes a state.
class RigReplay : public ::testing::Test {
 protected:
  ~RigReplay() override { std::filesystem::remove_all(folder); }

  /// Coupled, let go, pressed again; then a motor of the follower is not heard any more.
  void leave_a_log() {
    const runtime::FlushedDenormals as_a_servo_thread;
    Bench bench;
    runtime::JointStreams streams(bench.leader->limits().size());
    auto about = runtime::LogMetadata{{"tactus", {{"configuration", configuration::to_toml(bench.setup.params)}}}};
    about["tactus"]["rig"] = "arm";
    about["tactus"]["joints"] = "one,two,three";
    about["device_of_master"] = runtime::in_words(bench.leader->limits());
    about["device_of_slave"] = runtime::in_words(bench.follower->limits());
    about["urdf"] = runtime::urdfs_of(bench.setup);
    auto log = runtime::SiteLog::create(folder / "log", streams, about);
    ASSERT_TRUE(log) << describe(log.error());
    bench.loop->leave_in(streams);
    ASSERT_TRUE(bench.couple());
    bench.exchange.words.try_push({runtime::SiteWord::set, 0.25});
    bench.run(0.5);
    bench.exchange.words.try_push(runtime::SiteWord::tare);
    bench.run(5.0);
    EXPECT_EQ(bench.last.follower_tare.report.state, control::TareState::done);
    bench.exchange.words.try_push(runtime::SiteWord::press);
    bench.run(1.0);
    bench.follower_link->cut = true;
    bench.run(2.0);
    EXPECT_EQ(bench.last.leader, SiteState::hold);
    ticks = bench.loop->totals().ticks;
    ASSERT_FALSE(log->close());
    ASSERT_EQ(log->dropped(), 0U);
  }
  /// What is said of the log with this change.
  [[nodiscard]] std::string refusal(const std::function<void(telemetry::LogContent&)>& change) const {
    const auto replayed = replay(changed_log(folder / "log", change));
    return replayed ? "is replayed" : describe(replayed.error());
  }

  std::filesystem::path folder = scratch_path();
  std::int64_t ticks = 0;
};

TEST_F(RigReplay, TheLogOfTwoArmsReplaysBitForBitAndEveryChangeIsFound) {
  leave_a_log();
  const auto replayed = replay(folder / "log");
  ASSERT_TRUE(replayed) << describe(replayed.error());
  EXPECT_EQ(replayed->of, "both sites of 8 joints");
  EXPECT_EQ(replayed->ticks, ticks);
  ASSERT_FALSE(replayed->difference) << replayed->difference->topic << " " << replayed->difference->signal << " at "
                                     << replayed->difference->tick;

  const auto row = static_cast<std::size_t>(ticks) - 1200;
  for (const char* signal : {"position_m", "drive_velocity_m_per_s", "motor_force_N", "drive_stiffness_N_per_m",
                             "drive_damping_N_s_per_m", "law_position_m", "sent_position_m"}) {
    const auto found = replay(tampered(folder / "log", "/master/joint_3", signal, row));
    ASSERT_TRUE(found) << describe(found.error());
    ASSERT_TRUE(found->difference) << signal;
    EXPECT_GE(found->difference->tick, static_cast<std::int64_t>(row)) << signal;
    // A velocity that is off by its last digit is filtered before anything differs.
    EXPECT_LE(found->difference->tick, static_cast<std::int64_t>(row) + 100) << signal;
    if (std::string(signal) != "motor_force_N") continue;
    EXPECT_EQ(found->difference->topic, "/master/joint_3");
    EXPECT_EQ(found->difference->joint, "three");
    EXPECT_EQ(found->difference->signal, "motor_force_N");
  }
  // What was believed of the arm is in the log, and counts.
  const auto other = replay(changed_log(folder / "log", [](telemetry::LogContent& content) {
    for (auto& [name, text] : content.summary.metadata["urdf"]) {
      const std::string mass = "mass value=\"0.";
      text.insert(text.rfind(mass) + mass.size(), "0");
    }
  }));
  ASSERT_TRUE(other) << describe(other.error());
  EXPECT_TRUE(other->difference);

  const auto without = [this](const char* name) {
    return refusal([name](telemetry::LogContent& content) { content.summary.metadata.erase(name); });
  };
  EXPECT_NE(without("urdf").find("does not have the URDF of its arms (urdf)"), std::string::npos) << without("urdf");
  EXPECT_NE(without("device_of_slave").find("the limits of the joints (device_of_slave)"), std::string::npos);
  const auto lacks = [this](const char* topic) {
    return refusal([topic](telemetry::LogContent& content) {
      std::erase_if(content.tables, [topic](const auto& table) { return table.topic == topic; });
    });
  };
  EXPECT_NE(lacks("/master/joint_2").find("no topic /master/joint_2"), std::string::npos) << lacks("/master/joint_2");
  EXPECT_NE(lacks("/slave/joint_8").find("8 joints at the master and 7 at the slave"), std::string::npos);
  EXPECT_NE(lacks("/slave/site").find("no topic /slave/site"), std::string::npos);
  const std::string shorter = refusal([](telemetry::LogContent& content) {
    for (auto& table : content.tables) {
      if (table.topic == "/slave/joint_4") table.times_ns.pop_back();
    }
  });
  EXPECT_NE(shorter.find("topic /slave/joint_4 has "), std::string::npos) << shorter;
  const std::string late = refusal([](telemetry::LogContent& content) {
    for (auto& table : content.tables) {
      if (table.topic == "/slave/joint_4") table.values[0][10] += 1.0;
    }
  });
  EXPECT_NE(late.find("topic /slave/joint_4: control cycle 10 is missing"), std::string::npos) << late;
}

/// As of a program that was killed: what all topics have is replayed.
TEST_F(RigReplay, ALogThatWasCutReplaysAsFarAsItGoes) {
  leave_a_log();
  const auto file = folder / "log" / "log.mcap";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  const auto replayed = replay(file);
  ASSERT_TRUE(replayed) << describe(replayed.error());
  EXPECT_FALSE(replayed->difference);
  EXPECT_GT(replayed->ticks, 100);
  EXPECT_LT(replayed->ticks, ticks);
}

}  // namespace rig_arms_test
}  // namespace tactus::devices
