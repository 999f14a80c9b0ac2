// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/telemetry/episodes.hpp>
#include <tactus/data/telemetry/export.hpp>
#include <tactus/data/telemetry/wide_table.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::telemetry {
namespace episodes_test {

using control::SiteState;
using runtime::EpisodeMark;
using runtime::JointLogRecord;
using runtime::SiteTickRecord;

constexpr std::int64_t start_unix_ns = 1'764'482'400'123'456'789;  // 2025-11-30T06:00:00.123456789Z, by GNU date
constexpr double tick_s = 0.002;

struct Mark {
  double at_s;
  EpisodeMark mark;
};

/// A rig of a joint that turns and one that slides, at 500 Hz, whose arms follow from 1 to 3 s and from 4 to 6 s.
class RigEpisodes : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static double place(double t_s) { return 0.2 * std::sin(3.0 * t_s); }
  static double age_s(std::uint32_t tick) { return tick % 2 == 0 ? 0.0004 : 0.0011; }
  static bool follows(double t_s) { return (t_s >= 1.0 && t_s < 3.0) || (t_s >= 4.0 && t_s < 6.0); }

  static ChannelDescription channel(const std::string& topic, const std::string& joint, bool turns) {
    ChannelDescription made{.topic = topic,
                            .type_name = turns ? "t/msg/TurningJoint" : "t/msg/Joint",
                            .columns = columns_of<JointLogRecord>(),
                            .about = {{"joint", joint}}};
    for (Column& column : made.columns) {
      if (turns) column = of_turning_joint(column);
    }
    return made;
  }

  [[nodiscard]] std::filesystem::path leave(const std::vector<Mark>& marks, bool states_start = true) const {
    auto log = LogWriter::create(folder_ / "log.mcap").value();
    log.add_metadata("tactus", {{"rig", "arm"}, {"joints", "elbow,lift"}});
    if (states_start) log.start_at(start_unix_ns);
    std::vector<std::uint16_t> sites, joints;
    for (const std::string side : {"/master", "/slave"}) {
      sites.push_back(log.add_channel({side + "/site", "t/msg/Site", columns_of<SiteTickRecord>()}));
      joints.push_back(log.add_channel(channel(side + "/joint_1", "elbow", true)));
      joints.push_back(log.add_channel(channel(side + "/joint_2", "lift", false)));
    }
    const auto episodes =
        log.add_channel({episodes_topic, "t/msg/EpisodeMark", columns_of<runtime::EpisodeMarkRecord>()});
    for (std::uint32_t tick = 0; tick < 3500; ++tick) {
      const double now_s = tick_s * tick;
      const std::uint64_t time_ns = std::uint64_t{2'000'000} * tick;
      SiteTickRecord site;
      site.tick = tick;
      site.state = static_cast<std::int64_t>(follows(now_s) ? SiteState::active : SiteState::armed);
      for (std::size_t i = 0; i < 2; ++i) {
        log.write(sites[i], tick, time_ns, to_cdr(site));
        for (std::size_t j = 0; j < 2; ++j) {
          const double scale = static_cast<double>(1 + j) * (i == 0 ? 1.0 : -1.0);
          JointLogRecord record;
          record.tick = tick;
          record.position_age_s = age_s(tick);
          record.position_m = scale * place(now_s - record.position_age_s);
          record.drive_force_N = scale;
          static_cast<JointLogRecord::Sent&>(record).force_N = i == 1 ? -3.0 * scale : 0.0;
          log.write(joints[2 * i + j], tick, time_ns, to_cdr(record));
        }
      }
      for (const Mark& mark : marks) {
        if (std::lround(mark.at_s / tick_s) != static_cast<long>(tick)) continue;
        log.write(episodes, 0, time_ns, to_cdr(runtime::EpisodeMarkRecord{tick, static_cast<std::int64_t>(mark.mark)}));
      }
    }
    EXPECT_FALSE(log.close());
    return folder_ / "log.mcap";
  }
  [[nodiscard]] std::vector<Episode> episodes(const std::vector<Mark>& marks) const {
    return episodes_of(read_log(leave(marks)).value());
  }
  static void expect(const Episode& episode, double from_s, double to_s, bool discarded) {
    EXPECT_NEAR(1e-9 * static_cast<double>(episode.from_ns), from_s, 1e-9) << episode.number;
    EXPECT_NEAR(1e-9 * static_cast<double>(episode.to_ns), to_s, 1e-9) << episode.number;
    EXPECT_EQ(episode.discarded, discarded) << episode.number;
  }
  /// The lines of a file, split at commas.
  static std::vector<std::vector<std::string>> table(const std::filesystem::path& file) {
    std::ifstream text(file);
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(text, line);) {
      rows.emplace_back();
      std::istringstream fields(line);
      for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
    }
    return rows;
  }

  std::filesystem::path folder_ = scratch_path();
};

TEST_F(RigEpisodes, EachStretchFromArmingToReleaseIsOne) {
  const auto found = episodes({});
  ASSERT_EQ(found.size(), 2U);
  expect(found[0], 1.0, 2.998, false);
  expect(found[1], 4.0, 5.998, false);
}

TEST_F(RigEpisodes, MarksStartKeepAndDiscard) {
  // Within the first stretch two by `start`; the first of the second is kept at 4.5 s, and from then to 5 s is none.
  const auto found = episodes({{1.5, EpisodeMark::start},
                               {2.0, EpisodeMark::discard},
                               {4.5, EpisodeMark::keep},
                               {5.0, EpisodeMark::start},
                               {6.5, EpisodeMark::discard}});
  ASSERT_EQ(found.size(), 4U);
  expect(found[0], 1.0, 1.5, false);
  expect(found[1], 1.5, 2.0, true);
  expect(found[2], 4.0, 4.5, false);
  // Released at 6 s, discarded afterwards.
  expect(found[3], 5.0, 5.998, true);
}

TEST_F(RigEpisodes, TheLogHasWallClockTimesForOthersAndTimesSinceItsStartForUs) {
  const auto file = leave({});
  std::uint64_t first_ns = 0;
  ASSERT_TRUE(scan_log(file, [&](const LogChannel&, const LogMessage& message) -> Check {
    if (first_ns == 0) first_ns = message.time_ns;
    return std::nullopt;
  }));
  EXPECT_EQ(first_ns, static_cast<std::uint64_t>(start_unix_ns));
  const auto content = read_log(file).value();
  EXPECT_EQ(content.start_unix_ns, static_cast<std::uint64_t>(start_unix_ns));
  EXPECT_EQ(content.summary.metadata.at("clock").at("start_utc"), "2025-11-30T06:00:00.123456Z");
  EXPECT_EQ(content.tables.front().times_ns[5], 10'000'000U);
}

TEST_F(RigEpisodes, AWideTableHasNamesUnitsWallTimesAndValuesOfTheirInstant) {
  const auto log = WideLog::read(leave({{5.0, EpisodeMark::discard}}));
  ASSERT_TRUE(log) << describe(log.error());
  ASSERT_EQ(log->episodes().size(), 2U);
  EXPECT_TRUE(log->states_units());
  EXPECT_EQ(WideLog::rows(log->episodes().front(), 50.0), 100U);
  const auto file = folder_ / "wide.csv";
  ASSERT_FALSE(log->export_csv(log->episodes().front(), 50.0, file));
  const auto rows = table(file);
  const std::vector<std::string> heads{"time_s",
                                       "wall_time_s",
                                       "leader.elbow.position_rad",
                                       "leader.lift.position_m",
                                       "leader.elbow.velocity_rad_per_s",
                                       "leader.lift.velocity_m_per_s",
                                       "leader.elbow.torque_Nm",
                                       "leader.lift.force_N",
                                       "leader.elbow.commanded_torque_Nm",
                                       "leader.lift.commanded_force_N",
                                       "leader.state",
                                       "leader.cause"};
  ASSERT_EQ(rows.size(), 101U);
  for (const std::string& head : heads) {
    EXPECT_NE(std::find(rows[0].begin(), rows[0].end(), head), rows[0].end()) << head;
  }
  const auto column = [&](const std::string& head) {
    const auto found = std::find(rows[0].begin(), rows[0].end(), head);
    EXPECT_NE(found, rows[0].end()) << head;
    return static_cast<std::size_t>(found - rows[0].begin());
  };
  const auto number = [&](std::size_t row, const std::string& head) { return std::stod(rows[row].at(column(head))); };
  for (std::size_t row = 1; row < rows.size(); ++row) {
    const double since_s = 0.02 * static_cast<double>(row - 1);
    ASSERT_NEAR(number(row, "time_s"), since_s, 1e-9);
    ASSERT_NEAR(number(row, "wall_time_s"), 1e-9 * static_cast<double>(start_unix_ns) + 1.0 + since_s, 1e-5);
    // Taken at the tick they would be up to 0.7 mrad off; a straight line between two is 1e-6 off.
    ASSERT_NEAR(number(row, "leader.elbow.position_rad"), place(1.0 + since_s), 5e-6);
    ASSERT_NEAR(number(row, "follower.lift.position_m"), -2.0 * place(1.0 + since_s), 1e-5);
    ASSERT_EQ(number(row, "follower.elbow.external_torque_Nm"), -3.0);
    ASSERT_EQ(number(row, "follower.lift.external_force_N"), -6.0);
    ASSERT_EQ(rows[row].at(column("follower.state")), "active");
    ASSERT_EQ(rows[row].at(column("follower.cause")), "none");
  }
  // The commands for recordings read it too, its words among the numbers.
  const auto read = recording::read({.file = file, .variable = "follower.lift.position_m"});
  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->unit, "m");
  EXPECT_EQ(read->values.size(), 100U);
  EXPECT_NEAR(read->sample_time_s.value_or(0.0), 0.02, 1e-9);
  const auto torque = recording::read({.file = file, .variable = "follower.elbow.external_torque_Nm"});
  ASSERT_TRUE(torque) << describe(torque.error());
  EXPECT_EQ(torque->unit, "N m");
}

TEST_F(RigEpisodes, ATableThatNobodyCouldHoldIsRefused) {
  const auto log = WideLog::read(leave({})).value();
  const auto wrong =
      log.export_csv({.number = 1, .from_ns = 0, .to_ns = ~std::uint64_t{0}}, 50.0, folder_ / "wide.csv");
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->code, ErrorCode::out_of_bounds);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "wide.csv"));
}

TEST_F(RigEpisodes, OurSignalsHaveTheNamesOfTodayInLogsThatCalledThemOtherwise) {
  auto log = LogWriter::create(folder_ / "old_names.mcap").value();
  auto columns = columns_of<JointLogRecord>();
  for (Column& column : columns) {
    if (column.name == "sent_force_N") column.name = "told_force_N";
    if (column.name == "received_position_m") column.name = "heard_position_m";
  }
  for (const std::string type : {"tactus_msgs", "other_msgs"}) {
    log.write(log.add_channel({"/" + type, type + "/msg/JointRecord", columns}), 0, 0, to_cdr(JointLogRecord{}));
  }
  ASSERT_FALSE(log.close());
  const auto content = read_log(folder_ / "old_names.mcap").value();
  EXPECT_NE(content.find("/tactus_msgs")->find("sent_force_N"), nullptr);
  EXPECT_NE(content.find("/tactus_msgs")->find("received_position_m"), nullptr);
  EXPECT_NE(content.find("/other_msgs")->find("told_force_N"), nullptr);
}

TEST_F(RigEpisodes, ALogOfAnEarlierVersionIsReadWithoutUnitsAndWallTime) {
  auto content = read_log(leave({}, false)).value();
  // As it was written: every joint as if it slid, without a name.
  auto log = LogWriter::create(folder_ / "old.mcap").value();
  log.add_metadata("tactus", content.summary.metadata.at("tactus"));
  for (const LogTable& table : content.tables) {
    const bool joint = table.topic.find("/joint_") != std::string::npos;
    const auto columns = joint ? columns_of<JointLogRecord>() : table.columns;
    const auto channel = log.add_channel({table.topic, joint ? "t/msg/Joint" : "t/msg/Site", columns});
    for (std::size_t row = 0; row < table.times_ns.size(); ++row) {
      SiteTickRecord site;
      JointLogRecord record;
      if (joint) record.position_m = (*table.find(table.topic.ends_with("1") ? "position_rad" : "position_m"))[row];
      if (!joint) site.state = static_cast<std::int64_t>((*table.find("state"))[row]);
      const auto number = static_cast<std::uint32_t>(row);
      joint ? log.write(channel, number, table.times_ns[row], to_cdr(record))
            : log.write(channel, number, table.times_ns[row], to_cdr(site));
    }
  }
  ASSERT_FALSE(log.close());
  const auto wide = WideLog::read(folder_ / "old.mcap");
  ASSERT_TRUE(wide) << describe(wide.error());
  EXPECT_FALSE(wide->states_units());
  ASSERT_EQ(wide->episodes().size(), 2U);
  const auto heads = wide->heads();
  EXPECT_EQ(heads[1], "leader.elbow.position");
}

TEST_F(RigEpisodes, ALogWithoutSitesIsRefusedWithTheRemedy) {
  auto log = LogWriter::create(folder_ / "other.mcap").value();
  const auto channel = log.add_channel({"/other", "t/msg/Joint", columns_of<JointLogRecord>()});
  log.write(channel, 0, 0, to_cdr(JointLogRecord{}));
  ASSERT_FALSE(log.close());
  const auto wide = WideLog::read(folder_ / "other.mcap");
  ASSERT_FALSE(wide);
  EXPECT_NE(describe(wide.error()).find("no site of a leader or follower"), std::string::npos);
}

TEST_F(RigEpisodes, ExportsHaveWallTimesNamesOfJointsAndWordsOfCodes) {
  const auto content = read_log(leave({}), "/slave/site").value();
  ASSERT_FALSE(export_csv(content, folder_ / "site.csv"));
  const auto rows = table(folder_ / "site.csv");
  const auto column = [&](const std::string& head) {
    return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), head) - rows[0].begin());
  };
  EXPECT_EQ(rows[0][0], "time [s]");
  EXPECT_EQ(rows[0][1], "wall_time [s]");
  EXPECT_NEAR(std::stod(rows[1][1]), 1e-9 * static_cast<double>(start_unix_ns), 1e-6);
  EXPECT_EQ(rows[1].at(column("state_text")), "armed");
  EXPECT_EQ(rows[501].at(column("state_text")), "active");
  EXPECT_EQ(column("pressed_text"), rows[0].size()) << "buttons are added up, which no one word says";
  ASSERT_FALSE(export_csv(read_log(leave({}), "/slave/joint_1").value(), folder_ / "joint.csv"));
  const auto joint = table(folder_ / "joint.csv");
  EXPECT_EQ(joint[0], std::vector<std::string>{"# joint=elbow"});
  for (const char* head : {"position [rad]", "drive_velocity [rad/s]", "drive_torque [N m]",
                           "drive_stiffness [N m/rad]", "drive_damping [N m s/rad]", "sent_torque [N m]"}) {
    EXPECT_NE(std::find(joint[1].begin(), joint[1].end(), head), joint[1].end()) << head;
  }
}

TEST(TurningJoint, UnitsAndNamesAreThoseOfAJointThatTurns) {
  const auto turned = [](const char* name, const char* unit) {
    const Column column = of_turning_joint({.name = name, .unit = unit});
    return column.name + " " + column.unit;
  };
  EXPECT_EQ(turned("position_m", "m"), "position_rad rad");
  EXPECT_EQ(turned("drive_velocity_m_per_s", "m/s"), "drive_velocity_rad_per_s rad/s");
  EXPECT_EQ(turned("motor_force_N", "N"), "motor_torque_N_m N m");
  EXPECT_EQ(turned("drive_stiffness_N_per_m", "N/m"), "drive_stiffness_N_m_per_rad N m/rad");
  EXPECT_EQ(turned("drive_damping_N_s_per_m", "N s/m"), "drive_damping_N_m_s_per_rad N m s/rad");
  EXPECT_EQ(turned("given_J", "J"), "given_J J");
  EXPECT_EQ(turned("tick", ""), "tick ");
}

}  // namespace episodes_test
}  // namespace tactus::telemetry
