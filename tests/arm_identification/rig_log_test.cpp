// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/identification/arm/rig_log.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::arm_identification {
namespace rig_log_test {

using control::SiteState;
using runtime::JointLogRecord;
using runtime::SiteTickRecord;
using telemetry::LogWriter;

constexpr double tick_s = 0.002, cycle_s = 0.0032;

// What the drives of a motion told: the first joint's velocity and torque follow from it.
double place(double t_s) { return 0.3 * std::sin(2.0 * std::numbers::pi * 0.7 * t_s); }
double speed(double t_s) { return 0.3 * 2.0 * std::numbers::pi * 0.7 * std::cos(2.0 * std::numbers::pi * 0.7 * t_s); }

struct Content {
  std::string joints = "lift,turn";
  double active_from_s = 1.0, active_to_s = 5.0;
  std::optional<double> silent_at_s = {};  ///< 0.1 s long, the second joint
  bool turning = true;                     ///< with the names of such joints; those of earlier versions had others
};

/// The log of a rig of two joints whose bus answers each 3.2 ms, the second joint 1 ms behind the first.
class RigLog : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string leave(const Content& run) const {
    auto log = LogWriter::create(folder_ / "log.mcap");
    log->add_metadata("tactus", {{"rig", "arm"}, {"joints", run.joints}});
    const auto site = log->add_channel({"/slave/site", "t/msg/Site", telemetry::columns_of<SiteTickRecord>()});
    std::vector<std::uint16_t> joint;
    auto columns = telemetry::columns_of<JointLogRecord>();
    if (run.turning) {
      for (telemetry::Column& column : columns) column = telemetry::of_turning_joint(column);
    }
    for (const char* topic : {"/slave/joint_1", "/slave/joint_2"}) {
      joint.push_back(log->add_channel({topic, "t/msg/Joint", columns}));
    }
    for (std::uint32_t tick = 0; tick < 3000; ++tick) {
      const double now_s = tick_s * tick;
      const auto time_ns = std::uint64_t{2'000'000} * tick;
      const bool active = now_s >= run.active_from_s && now_s < run.active_to_s;
      SiteTickRecord of_site;
      of_site.tick = tick;
      of_site.state = static_cast<std::int64_t>(active ? SiteState::active : SiteState::armed);
      log->write(site, tick, time_ns, telemetry::to_cdr(of_site));
      for (std::size_t i = 0; i < joint.size(); ++i) {
        const double behind_s = 0.001 * static_cast<double>(i);
        double heard_s = std::floor((now_s - behind_s) / cycle_s) * cycle_s + behind_s;
        if (i == 1 && run.silent_at_s && heard_s < *run.silent_at_s + 0.1)
          heard_s = std::min(heard_s, *run.silent_at_s);
        const double sign = i == 0 ? 1.0 : -1.0;
        JointLogRecord record;
        record.tick = tick;
        record.position_m = sign * place(heard_s);
        record.drive_velocity_m_per_s = sign * speed(heard_s);
        record.drive_stiffness_N_per_m = i == 0 ? 0.0 : 100.0;
        record.drive_force_N = (2.0 - 0.5 * record.drive_stiffness_N_per_m * cycle_s) * record.drive_velocity_m_per_s;
        record.position_age_s = now_s - heard_s;
        log->write(joint[i], tick, time_ns, telemetry::to_cdr(record));
      }
    }
    EXPECT_FALSE(log->close());
    return folder_.string();
  }
  [[nodiscard]] std::string complaint(const Content& run, const std::vector<std::string>& joints) const {
    const auto read = read_rig_log(leave(run), joints);
    return read ? "nothing" : describe(read.error());
  }

  std::filesystem::path folder_ = scratch_path();
};

TEST_F(RigLog, TellsTheFollowerAsItsDrivesDidWhileItFollowedInTheOrderThatIsAsked) {
  const auto read = read_rig_log(leave({}), {"turn", "lift"});
  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_EQ(read->size(), 1U);
  const auto& recording = read->front();
  EXPECT_NEAR(recording.start_s, 1.0, 0.01);
  EXPECT_NEAR(static_cast<double>(recording.samples()) * tick_s, 4.0, 0.02);
  EXPECT_EQ(recording.effort_unit, "N m");
  // Taken at the ticks, they would be up to 4.2 ms late, and 5 mrad off.
  for (std::size_t i = 0; i < recording.samples(); ++i) {
    const double t_s = recording.start_s + tick_s * static_cast<double>(i);
    ASSERT_NEAR(recording.position[0][i], -place(t_s), 1e-4) << t_s;
    ASSERT_NEAR(recording.position[1][i], place(t_s), 1e-4) << t_s;
    ASSERT_NEAR(recording.velocity[1][i], speed(t_s), 1e-3) << t_s;
    ASSERT_NEAR(recording.effort[0][i], -2.0 * speed(t_s), 2e-3) << t_s;
    ASSERT_NEAR(recording.effort[1][i], 2.0 * speed(t_s), 2e-3) << t_s;
  }
}

TEST_F(RigLog, OfAnEarlierVersionIsReadAsBefore) {
  const auto now = read_rig_log(leave({}), {"turn", "lift"});
  const auto before = read_rig_log(leave({.turning = false}), {"turn", "lift"});
  ASSERT_TRUE(now && before);
  EXPECT_EQ(before->front().position, now->front().position);
  EXPECT_EQ(before->front().effort, now->front().effort);
}

TEST_F(RigLog, IsCutWhereADriveWasSilent) {
  const auto read = read_rig_log(leave({.silent_at_s = 2.5}), {"lift", "turn"});
  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_EQ(read->size(), 2U);
  EXPECT_LT(read->at(0).start_s + tick_s * static_cast<double>(read->at(0).samples()), 2.51);
  EXPECT_GT(read->at(1).start_s, 2.59);
  const auto short_before = read_rig_log(leave({.silent_at_s = 1.5}), {"lift", "turn"});
  ASSERT_TRUE(short_before);
  EXPECT_EQ(short_before->size(), 1U) << "half a second tells nothing";
}

TEST_F(RigLog, WhatCannotBeReadIsRefusedWithTheRemedy) {
  const auto expect = [](const std::string& said, const std::string& words) {
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect(complaint({}, {"lift", "elbow"}),
         "the arm's joint 'elbow' is not a joint of the rig, whose joints are lift, turn: call");
  expect(complaint({.joints = ""}, {"lift"}), "no log of a rig whose joints have names: leave one with 'tactus run");
  expect(complaint({.active_to_s = 1.5}, {"lift"}), "the follower did not follow for 1 s");
}

TEST(ToldJoints, ValuesThatCannotBeMeasuredAreRefused) {
  for (const double value : {9e307, -2e30, std::numeric_limits<double>::infinity(), std::nan("")}) {
    for (int signal = 0; signal < 3; ++signal) {
      ToldJoint joint{.time_s = {0.0, 0.001, 0.002},
                      .position = {0.0, 0.1, 0.2},
                      .velocity = {1.0, 1.0, 1.0},
                      .effort = {0.5, 0.5, 0.5}};
      (signal == 0 ? joint.position : signal == 1 ? joint.velocity : joint.effort)[1] = value;
      const auto read = recording_of("rig.mcap", {joint}, {"elbow"}, Seconds{0.001});
      ASSERT_FALSE(read) << value;
      EXPECT_NE(describe(read.error()).find("joint 'elbow' has a value that is not finite, or is beyond 1e30"),
                std::string::npos)
          << describe(read.error());
    }
  }
}

}  // namespace rig_log_test
}  // namespace tactus::arm_identification
