// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/identification/diagnosis/signals.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace rig_signals_test {

using control::SiteState;
using runtime::JointLogRecord;
using runtime::SiteTickRecord;

constexpr double tick_s = 0.002;

/// The log of a rig of two joints at 500 Hz with two armings, from 1 to 3 s and from 4 to 7 s: the elbow shakes in the
/// second.
class RigSignals : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static double leader(int joint, double t_s) {
    const double slow = 0.2 * std::sin(2.0 * t_s + joint);
    return slow + (joint == 1 && t_s > 4.0 ? 0.01 * std::sin(2.0 * std::numbers::pi * 12.0 * t_s) : 0.0);
  }

  [[nodiscard]] SignalRoles leave(bool reports_torque = true) const {
    auto log = telemetry::LogWriter::create(folder_ / "log.mcap").value();
    log.add_metadata("tactus", {{"rig", "arm"}, {"joints", "shoulder,elbow"}});
    std::vector<std::uint16_t> sites, joints;
    for (const std::string side : {"/master", "/slave"}) {
      sites.push_back(log.add_channel({side + "/site", "t/msg/Site", telemetry::columns_of<SiteTickRecord>()}));
      auto columns = telemetry::columns_of<JointLogRecord>();
      for (telemetry::Column& column : columns) column = telemetry::of_turning_joint(column);
      for (const char* joint : {"/joint_1", "/joint_2"}) {
        joints.push_back(log.add_channel({side + joint, "t/msg/TurningJoint", columns}));
      }
    }
    for (std::uint32_t tick = 0; tick < 4000; ++tick) {
      const double now_s = tick_s * tick;
      const bool active = (now_s >= 1.0 && now_s < 3.0) || (now_s >= 4.0 && now_s < 7.0);
      SiteTickRecord site;
      site.tick = tick;
      site.state = static_cast<std::int64_t>(active ? SiteState::active : SiteState::armed);
      for (std::size_t side = 0; side < 2; ++side) {
        log.write(sites[side], tick, 2'000'000ULL * tick, telemetry::to_cdr(site));
        for (int joint = 0; joint < 2; ++joint) {
          JointLogRecord record;
          record.tick = tick;
          record.position_m = side == 0 ? leader(joint, now_s) : leader(joint, now_s - 0.01);
          record.motor_force_N = side == 0 ? -1.0 - record.position_m : 2.0 * record.position_m;
          record.drive_force_N = reports_torque ? record.motor_force_N + 0.5 : 0.0;
          log.write(joints[2 * side + static_cast<std::size_t>(joint)], tick, 2'000'000ULL * tick,
                    telemetry::to_cdr(record));
        }
      }
    }
    EXPECT_FALSE(log.close());
    SignalRoles roles;
    roles.file = folder_;
    return roles;
  }

  std::filesystem::path folder_ = scratch_path();
};

TEST_F(RigSignals, TheEpisodeAndTheJointThatShakeAreTakenWithUnitsAndSigns) {
  const auto found = read_signals(leave());
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_TRUE(found->rotary);
  EXPECT_EQ(found->samples, 1500U);
  EXPECT_NEAR(found->sample_time.value, tick_s, 1e-9);
  EXPECT_EQ(found->find(Role::master_position)->name, "master/joint_2.position_rad");
  EXPECT_EQ(found->find(Role::tip_force), nullptr) << "the follower tells no force";
  for (std::size_t i = 0; i < found->samples; ++i) {
    const double t_s = 4.0 + tick_s * static_cast<double>(i);
    ASSERT_NEAR(found->values(Role::master_position)[i], leader(1, t_s), 1e-12);
    ASSERT_NEAR(found->values(Role::slave_position)[i], leader(1, t_s - 0.01), 1e-12);
    // What the motor reports, positive where it pushes the hand back.
    ASSERT_NEAR(found->values(Role::displayed_force)[i], 0.5 + leader(1, t_s), 1e-12);
    ASSERT_NEAR(found->values(Role::slave_force)[i], 0.5 + 2.0 * leader(1, t_s - 0.01), 1e-12);
  }
  ASSERT_EQ(found->notes.size(), 2U);
  EXPECT_NE(found->notes[0].find("joint 'elbow' moves most roughly and was taken, of shoulder, elbow"),
            std::string::npos)
      << found->notes[0];
  EXPECT_NE(found->notes[1].find("the log has 2 episodes: number 2, from 4 to 6.998 s"), std::string::npos)
      << found->notes[1];
}

TEST_F(RigSignals, AMotorThatReportsNoTorqueIsTakenByItsCommand) {
  const auto found = read_signals(leave(false));
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_NEAR(found->values(Role::displayed_force)[0], 1.0 + leader(1, 4.0), 1e-12);
}

TEST_F(RigSignals, AJointIsNamedAndAWrongNameIsRefusedWithThoseOfTheRig) {
  SignalRoles roles = leave();
  roles.joint = "shoulder";
  const auto found = read_signals(roles);
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_EQ(found->find(Role::slave_position)->name, "slave/joint_1.position_rad");
  roles.joint = "wrist";
  const auto refused = read_signals(roles);
  ASSERT_FALSE(refused);
  EXPECT_NE(describe(refused.error()).find("no joint 'wrist': the rig has shoulder, elbow"), std::string::npos);
}

}  // namespace rig_signals_test
}  // namespace tactus::diagnosis
