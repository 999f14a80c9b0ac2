// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/columns.hpp>
#include <tactus/identification/diagnosis/signals.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace signals_test {

class ReadSignals : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  /// Two seconds at 1 kHz of four columns: time, and three that move.
  SignalRoles table(const std::string& header, double time_scale = 1e-3) const {
    std::ofstream file(file_);
    file << header << "\n";
    for (int i = 0; i < 2000; ++i) {
      char line[160];
      std::snprintf(line, sizeof line, "%.10g,%.6f,%.6f,%.6f\n", i * time_scale, std::sin(0.01 * i),
                    std::sin(0.01 * i - 0.2), 10.0 * std::cos(0.01 * i));
      file << line;
    }
    return {.file = file_};
  }
  static std::string all_notes(const Signals& signals) {
    std::string notes;
    for (const std::string& note : signals.notes) notes += note + "\n";
    return notes;
  }
  const std::filesystem::path file_ = scratch_path().string() + ".csv";
};

TEST_F(ReadSignals, MasterAndSlaveAreFoundByTheNamesOfTheField) {
  for (const char* header : {"time,x_m,x_s,other", "time,q_m,q_s,other", "time [s],x_m [m],x_s [m],other"}) {
    const auto signals = read_signals(table(header));
    ASSERT_TRUE(signals) << header << describe(signals.error());
    ASSERT_NE(signals->find(Role::slave_position), nullptr) << header;
    EXPECT_NEAR(signals->find(Role::slave_position)->values[500], std::sin(5.0 - 0.2), 1e-6) << header;
    EXPECT_NEAR(signals->find(Role::master_position)->values[500], std::sin(5.0), 1e-6) << header;
  }
}

TEST_F(ReadSignals, CentimetresAndSpelledUnitsAreConverted) {
  const auto signals =
      read_signals(table("time [sec],master position (cm),slave position (meters),tip force (Newton)"));
  ASSERT_TRUE(signals) << describe(signals.error());
  EXPECT_NEAR(signals->find(Role::master_position)->values[500], 0.01 * std::sin(5.0), 1e-8);
  EXPECT_NEAR(signals->find(Role::slave_position)->values[500], std::sin(4.8), 1e-6);
  ASSERT_NE(signals->find(Role::tip_force), nullptr);
}

TEST_F(ReadSignals, AColumnThatIsNotUsedIsSaidAndWhyWhereItsUnitIsTheReason) {
  const auto signals = read_signals(table("time [s],master_position [m],slave_position [m],tip_force [mA]"));
  ASSERT_TRUE(signals) << describe(signals.error());
  const std::string notes = all_notes(*signals);
  EXPECT_NE(notes.find("'tip_force' is called like a tip force, but mA is no unit of one"), std::string::npos) << notes;
  EXPECT_NE(notes.find("columns not used: 'tip_force' in mA"), std::string::npos) << notes;
  EXPECT_EQ(all_notes(*read_signals(table("time,master_position,slave_position,tip_force"))), "");
}

TEST_F(ReadSignals, AForceThatIsSwitchedBetweenTwoLevelsIsNotResolvedInThatStep) {
  std::string text = "time_s,master_position_m,displayed_force_N\n";
  for (int i = 0; i < 1000; ++i) {
    text +=
        std::to_string(0.001 * i) + "," + std::to_string(0.01 * std::sin(0.1 * i)) + (i % 60 < 20 ? ",5" : ",0") + "\n";
  }
  std::ofstream(file_) << text;
  const auto signals = read_signals({.file = file_});
  ASSERT_TRUE(signals) << describe(signals.error());
  const Channel* force = signals->find(Role::displayed_force);
  ASSERT_NE(force, nullptr);
  EXPECT_FALSE(force->constant());
  EXPECT_LT(force->step, 0.1);
}

TEST_F(ReadSignals, TimesWithoutAUnitThatNoRecordingHasAreRefusedAndTheUnitHelps) {
  SignalRoles roles = table("time,x_m,x_s,other", 1.0);
  auto signals = read_signals(roles);
  ASSERT_FALSE(signals);
  EXPECT_NE(signals.error().message.find("1 s apart"), std::string::npos) << signals.error().message;
  EXPECT_NE(signals.error().message.find("--time-unit ms"), std::string::npos) << signals.error().message;
  roles.time_unit = "ms";
  signals = read_signals(roles);
  ASSERT_TRUE(signals) << describe(signals.error());
  EXPECT_DOUBLE_EQ(signals->sample_time.value, 0.001);
}

TEST_F(ReadSignals, AMeasuredVelocityContradictsATimeInTheWrongUnit) {
  const char* header = "time,leader_position [rad],follower_position [rad],leader_velocity [rad/s]";
  EXPECT_TRUE(read_signals(table(header)));
  const auto signals = read_signals(table(header, 1.0));
  ASSERT_FALSE(signals);
  EXPECT_NE(signals.error().message.find("by the measured velocity 'leader_velocity'"), std::string::npos)
      << signals.error().message;
}

}  // namespace signals_test
}  // namespace tactus::diagnosis
