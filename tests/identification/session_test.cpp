// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/recording.hpp>
#include <tactus/identification/axis/session.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::identification {
namespace session_test {

/// A device that answers with what no two runs share, and counts what it is asked.
class CountingRig final : public Rig {
 public:
  std::string called = "bench A";
  bool monitored = true;
  int runs = 0;
  std::vector<Assembly> assembled;
  [[nodiscard]] std::string name() const override { return called; }
  [[nodiscard]] double tick_s() const override { return 200e-6; }
  [[nodiscard]] RigLimits limits() const override { return {}; }
  Check assemble(Assembly assembly) override {
    assembled.push_back(assembly);
    return {};
  }
  Result<RigRun> run(const MotorProgram& program) override {
    ++runs;
    RigRun record;
    record.tick_s = tick_s();
    for (std::size_t i = 0; i < length(program); ++i) {
      record.commanded_force_N.push_back(program.force_N[i] + 1e-17 * runs);
      record.position_m.push_back(std::sin(0.1 * runs * static_cast<double>(i)) / 3.0);
      if (monitored) record.current_force_N.push_back(std::sqrt(static_cast<double>(i) + runs));
    }
    return record;
  }
};

class Session : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = scratch_path();
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  static MotorProgram program(double force_N) {
    MotorProgram made;
    made.force_N.assign(30, force_N);
    return made;
  }
  [[nodiscard]] std::filesystem::path file(const char* name) const { return folder_ / name; }
  [[nodiscard]] std::string content(const char* name) const {
    std::ostringstream text;
    text << std::ifstream(file(name)).rdbuf();
    return text.str();
  }
  void overwrite(const char* name, const std::string& text) const { std::ofstream(file(name)) << text; }
  void expect_refused(CountingRig& rig, const char* named) const {
    auto session = SessionRig::open(rig, folder_).value();
    ASSERT_FALSE(session.assemble(Assembly::motor));
    const auto run = session.run(program(0.5));
    ASSERT_FALSE(run);
    const std::string message = describe(run.error());
    EXPECT_NE(message.find("run-001.csv"), std::string::npos) << message;
    EXPECT_NE(message.find(named), std::string::npos) << message;
  }

  std::filesystem::path folder_;
};

TEST_F(Session, WhatWasRunBeforeAStopComesFromTheFolderBitForBit) {
  CountingRig rig;
  std::vector<RigRun> first;
  {
    auto session = SessionRig::open(rig, folder_).value();
    ASSERT_FALSE(session.assemble(Assembly::motor));
    first.push_back(session.run(program(0.5)).value());
    first.push_back(session.run(program(0.25)).value());
  }
  auto session = SessionRig::open(rig, folder_).value();
  ASSERT_FALSE(session.assemble(Assembly::motor));
  for (const auto& [force_N, index] : {std::pair{0.5, 0U}, std::pair{0.25, 1U}}) {
    const auto again = session.run(program(force_N)).value();
    EXPECT_EQ(again.commanded_force_N, first[index].commanded_force_N);
    EXPECT_EQ(again.position_m, first[index].position_m);
    EXPECT_EQ(again.current_force_N, first[index].current_force_N);
  }
  EXPECT_EQ(rig.runs, 2);
  EXPECT_EQ(session.replayed(), 2U);
  ASSERT_TRUE(session.run(program(0.125)));
  EXPECT_EQ(rig.runs, 3);
}

TEST_F(Session, AMechanicalStepIsAskedForOnceAndOnlyForRunsThatAreMissing) {
  CountingRig rig;
  const auto work = [&](SessionRig& session, std::size_t stages) {
    const Assembly order[] = {Assembly::motor, Assembly::motor, Assembly::drum, Assembly::handle};
    for (std::size_t i = 0; i < stages; ++i) {
      ASSERT_FALSE(session.assemble(order[i]));
      ASSERT_TRUE(session.run(program(0.1 * static_cast<double>(i + 1))));
    }
  };
  auto session = SessionRig::open(rig, folder_).value();
  work(session, 3);
  EXPECT_EQ(rig.assembled, (std::vector{Assembly::motor, Assembly::drum}));
  rig.assembled.clear();
  auto resumed = SessionRig::open(rig, folder_).value();
  work(resumed, 4);
  EXPECT_EQ(rig.assembled, (std::vector{Assembly::handle}));
}

TEST_F(Session, ARunIsAnOrdinaryRecording) {
  CountingRig rig;
  auto session = SessionRig::open(rig, folder_).value();
  const auto run = session.run(program(0.5)).value();
  const auto position = recording::read({.file = file("run-001.csv"), .variable = "position"});
  ASSERT_TRUE(position) << describe(position.error());
  EXPECT_EQ(position->values, run.position_m);
  EXPECT_EQ(position->unit, "m");
  EXPECT_NEAR(position->sample_time_s.value(), 200e-6, 1e-12);
}

TEST_F(Session, ARigWithoutACurrentMonitorComesBackWithoutOne) {
  CountingRig rig;
  rig.monitored = false;
  auto session = SessionRig::open(rig, folder_).value();
  ASSERT_TRUE(session.run(program(0.5)));
  auto again = SessionRig::open(rig, folder_).value();
  const auto run = again.run(program(0.5));
  ASSERT_TRUE(run) << describe(run.error());
  EXPECT_TRUE(run->current_force_N.empty());
  EXPECT_EQ(run->position_m.size(), 30U);
}

TEST_F(Session, AForeignOrDamagedRunIsRefusedWithItsName) {
  CountingRig rig;
  {
    auto session = SessionRig::open(rig, folder_).value();
    ASSERT_FALSE(session.assemble(Assembly::motor));
    ASSERT_TRUE(session.run(program(0.5)));
  }
  const std::string good = content("run-001.csv");
  CountingRig other;
  other.called = "bench B";
  expect_refused(other, "not the run that is needed");
  overwrite("run-001.csv", good.substr(0, good.rfind("\n", good.size() - 2) + 1));
  expect_refused(rig, "29 samples");
  overwrite("run-001.csv", good.substr(0, good.size() / 2));
  expect_refused(rig, "run-001.csv");
  std::string with_nan = good;
  with_nan.replace(with_nan.rfind(',') + 1, 3, "nan");
  overwrite("run-001.csv", with_nan);
  expect_refused(rig, "run-001.csv");
  overwrite("run-001.csv", "");
  expect_refused(rig, "not the run that is needed");
}

TEST_F(Session, AFolderThatCannotBeWrittenIsRefusedAtOnce) {
  CountingRig rig;
  std::ofstream(folder_) << "a file";
  const auto session = SessionRig::open(rig, folder_);
  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().code, ErrorCode::unwritable);
}

}  // namespace session_test
}  // namespace tactus::identification
