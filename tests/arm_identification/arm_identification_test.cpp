// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/external_torque.hpp>
#include <tactus/identification/arm/fit.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "tests/arm_identification/kdl_arm.hpp"
#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::arm_identification {
namespace {

const std::vector<std::string> names{"j1", "j2", "j3", "j4", "j5", "j6", "j7"};
const ArmColumns numbered{.time = "1", .position = "2:8", .velocity = "9:15", .effort = "16:22"};

/// A simulation as the recording that its file would give.
ArmRecording recorded(const Samples& samples) {
  ArmRecording recording{.file = "simulated.csv",
                         .position_names = names,
                         .effort_names = names,
                         .sample_time = Seconds{samples.time_s[1]}};
  recording.position = samples.position;
  recording.velocity = samples.velocity;
  recording.effort = samples.torque;
  return recording;
}

const arm::Chain::Params& truth() {
  static const arm::Chain::Params params = open_arm();
  return params;
}
const ArmRecording& free_motion(std::uint64_t seed) {
  static std::vector<ArmRecording> made(8);
  ArmRecording& recording = made.at(seed);
  if (recording.joints() == 0) recording = recorded(simulate(truth(), {.seed = seed}));
  return recording;
}
const ArmIdentification& identified() {
  static const ArmIdentification found =
      *identify_arm(std::array{free_motion(1), free_motion(2)}, names, believed(truth(), 3));
  return found;
}

TEST(ArmIdentification, TorquesOfUnseenMotionArePredictedWithinTwoPercent) {
  const auto unseen = estimate_external_torque(identified().model, free_motion(5));
  ASSERT_TRUE(unseen) << describe(unseen.error());
  for (std::size_t j = 0; j < names.size(); ++j) {
    EXPECT_LT(unseen->joints[j].relative, 0.02) << names[j];
    EXPECT_LT(identified().joints[j].held_out_relative, 1.05 * identified().joints[j].least_squares_relative);
  }
  EXPECT_FALSE(identified().scaled_efforts);
}

TEST(ArmIdentification, IntervalsHoldWhatTheSimulationHas) {
  int told = 0;
  int held = 0;
  int all = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto found =
        identify_arm(std::array{free_motion(seed), free_motion(seed + 1)}, names, believed(truth(), 10 + seed));
    ASSERT_TRUE(found) << describe(found.error());
    for (std::size_t j = 0; j < names.size(); ++j) {
      const arm::JointParams& joint = truth().joints[j];
      const arm::BodyVector body = arm::linear_parameters(joint.body);
      std::vector<double> values(body.begin(), body.end());
      values.insert(values.end(), {joint.drive.armature_kg_m2, joint.friction.coulomb_N_m,
                                   joint.friction.viscous_N_m_s_per_rad, joint.friction.offset_N_m});
      EXPECT_GT(found->joints[j].held_out_coverage, 0.9) << names[j];
      for (std::size_t k = 0; k < values.size(); ++k) {
        const ArmParameter& p = found->joints[j].parameters[k];
        const bool holds = values[k] >= p.lower && values[k] <= p.upper;
        ++all;
        told += p.determined ? 1 : 0;
        held += holds ? 1 : 0;
      }
    }
  }
  EXPECT_GT(told, all / 4);
  EXPECT_GE(held, all * 9 / 10) << told << " told, " << held << " of " << all << " held";
}

TEST(ArmIdentification, EveryBodyIsOneThatCanExist) {
  for (const ArmJointModel& joint : identified().model.joints) {
    EXPECT_FALSE(arm::check(joint.arm.body)) << joint.name;
    EXPECT_GT(joint.arm.body.mass_kg, 0.0);
    EXPECT_GE(joint.arm.friction.coulomb_N_m, 0.0);
  }
}

TEST(ArmIdentification, CurrentsWithAScaleForEachJointAreExplainedAsWellAsTorques) {
  const std::array<double, 7> scales{0.4, 7.0, 0.05, 120.0, 3.0, 0.9, 15.0};
  ArmRecording currents = free_motion(1);
  for (std::size_t j = 0; j < scales.size(); ++j) {
    for (double& value : currents.effort[j]) value *= scales[j];
  }
  const auto torques = identify_arm(std::array{free_motion(1)}, names, believed(truth(), 3));
  const auto found = identify_arm(std::array{currents}, names, believed(truth(), 3));
  ASSERT_TRUE(torques) << describe(torques.error());
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_TRUE(found->scaled_efforts);
  for (std::size_t j = 0; j < scales.size(); ++j) {
    EXPECT_NEAR(found->joints[j].relative, torques->joints[j].relative, 0.05 * torques->joints[j].relative) << names[j];
    EXPECT_LT(found->joints[j].relative, 0.02) << names[j];
  }
}

TEST(ArmIdentification, OnlyTheJointsWhoseTorqueConstantsAreOffHaveAScaleOfTheirOwn) {
  ArmRecording off = free_motion(1);
  for (double& value : off.effort[5]) value *= 1.25;
  for (double& value : off.effort[6]) value *= 0.75;
  const auto found = identify_arm(std::array{off}, names, believed(truth(), 3));
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_TRUE(found->scaled_efforts);
  const double common = found->joints[0].effort_per_N_m;
  for (std::size_t j = 1; j < 5; ++j) EXPECT_NEAR(found->joints[j].effort_per_N_m, common, 1e-6) << names[j];
  EXPECT_NEAR(found->joints[5].effort_per_N_m, 1.25 * common, 0.06);
  EXPECT_NEAR(found->joints[6].effort_per_N_m, 0.75 * common, 0.06);
  for (const ArmJointFit& joint : found->joints) {
    EXPECT_LT(joint.held_out_relative, 1.05 * joint.least_squares_relative) << joint.name;
  }
}

TEST(ArmIdentification, APushIsFoundWithinFiftyMillisecondsAndNoneInFreeMotion) {
  const std::vector<Push> pushes{{4.0, 4.6, 15.0}, {7.0, 8.0, -12.0}, {11.5, 11.8, 20.0}};
  const ArmRecording pushed = recorded(simulate(truth(), {.duration_s = 14.0, .seed = 6, .pushes = pushes}));
  const auto found = estimate_external_torque(identified().model, pushed);
  ASSERT_TRUE(found) << describe(found.error());
  ASSERT_EQ(found->contacts.size(), pushes.size());
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    EXPECT_NEAR(found->contacts[i].from_s, pushes[i].from_s, 0.05);
    EXPECT_NEAR(found->contacts[i].to_s, pushes[i].to_s, 0.05);
    EXPECT_FALSE(found->contacts[i].joints.empty());
  }
  // Free motion beside the pushes is explained as before.
  for (const ArmJointResidual& joint : found->joints) EXPECT_LT(joint.relative, 0.03) << joint.name;
  for (const std::uint64_t seed : {5U, 7U}) {
    EXPECT_TRUE(estimate_external_torque(identified().model, free_motion(seed))->contacts.empty()) << seed;
  }
}

TEST(ArmIdentification, TheExternalTorqueIsThatOfTheForceOnTheTool) {
  const ArmRecording pushed = recorded(simulate(truth(), {.duration_s = 8.0, .seed = 6, .pushes = {{3.0, 5.0, 15.0}}}));
  const auto found = estimate_external_torque(identified().model, pushed);
  ASSERT_TRUE(found) << describe(found.error());
  const auto row = static_cast<Eigen::Index>(std::lower_bound(found->time_s.begin(), found->time_s.end(), 4.0) -
                                             found->time_s.begin());
  const auto sample = static_cast<std::size_t>(std::lround(found->time_s[static_cast<std::size_t>(row)] * 500.0));
  arm::JointVector q(7);
  for (int j = 0; j < 7; ++j) q[j] = pushed.position[static_cast<std::size_t>(j)][sample];
  const arm::JointVector expected = arm::Chain::make(truth())->jacobian(q, 6, arm::Vector3::Zero()).transpose() *
                                    (Eigen::Matrix<double, 6, 1>() << 0.0, 0.0, 15.0, 0.0, 0.0, 0.0).finished();
  EXPECT_LT((found->torque_N_m.row(row).transpose() - expected).norm(), 0.1 * expected.norm());
}

/// An arm that holds a pose.
ArmRecording standing(std::uint64_t seed, double duration_s, const std::vector<Push>& pushes = {}) {
  const std::array<double, 7> pose{0.2, 0.4, 0.1, 1.2, 0.3, -0.2, 0.3};
  const auto hold = [pose](unsigned joint, double) { return pose.at(joint); };
  return recorded(simulate(truth(), {.duration_s = duration_s, .seed = seed, .pushes = pushes, .path = hold}));
}

TEST(ArmIdentification, AnArmThatStandsStillFeelsAPushAndItsSizeIsWithinFifteenPercentOrTheInterval) {
  const std::vector<Push> pushes{{2.0, 3.0, 5.0}, {4.0, 5.0, -10.0}, {6.0, 7.0, 20.0}};
  const ArmRecording still = standing(3, 9.0, pushes);
  const auto found = estimate_external_torque(identified().model, still);
  ASSERT_TRUE(found) << describe(found.error());
  ASSERT_EQ(found->contacts.size(), pushes.size());
  const arm::Chain chain = *arm::Chain::make(truth());
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    const ArmContact& contact = found->contacts[i];
    EXPECT_NEAR(contact.from_s, pushes[i].from_s, 0.1);
    EXPECT_NEAR(contact.to_s, pushes[i].to_s, 0.1);
    arm::JointVector q(7);
    const auto sample = static_cast<std::size_t>(500.0 * 0.5 * (pushes[i].from_s + pushes[i].to_s));
    for (int j = 0; j < 7; ++j) q[j] = still.position[static_cast<std::size_t>(j)][sample];
    const arm::JointVector expected =
        chain.jacobian(q, 6, arm::Vector3::Zero()).transpose() *
        (Eigen::Matrix<double, 6, 1>() << 0.0, 0.0, pushes[i].force_N, 0.0, 0.0, 0.0).finished();
    ASSERT_FALSE(contact.joints.empty());
    for (const ArmContactTorque& joint : contact.joints) {
      const auto j = std::find(names.begin(), names.end(), joint.joint) - names.begin();
      const double within = std::max(joint.within_N_m, 0.15 * std::fabs(expected[j]));
      EXPECT_NEAR(joint.mean_N_m, expected[j], within) << joint.joint << " of " << pushes[i].force_N << " N";
    }
  }
  const auto nothing = estimate_external_torque(identified().model, standing(4, 20.0));
  ASSERT_TRUE(nothing) << describe(nothing.error());
  EXPECT_TRUE(nothing->contacts.empty());
}

/// Stuck joints carry what they like within their friction: with no motor and gravity less than that, nothing is known.
TEST(ArmIdentification, AnArmThatIsHeldByItsFrictionAloneIsNotTakenForTouched) {
  ArmModel model = identified().model;
  ArmRecording still = standing(4, 5.0);
  for (std::size_t j = 0; j < names.size(); ++j) {
    for (double& effort : still.effort[j]) effort += 0.9 * model.joints[j].arm.friction.coulomb_N_m;
  }
  const auto found = estimate_external_torque(model, still);
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_TRUE(found->contacts.empty());
  // Twice as much can be no friction.
  for (std::size_t j = 0; j < names.size(); ++j) {
    const ArmJointModel& joint = model.joints[j];
    for (double& effort : still.effort[j]) {
      effort += joint.arm.friction.coulomb_N_m + 1.5 * joint.contact_threshold_N_m;
    }
  }
  EXPECT_EQ(estimate_external_torque(model, still)->contacts.size(), 1U);
}

TEST(ArmIdentification, StretchesOfALogAreEstimatedOneAfterTheOther) {
  ArmRecording late = recorded(simulate(truth(), {.duration_s = 6.0, .seed = 6, .pushes = {{3.0, 4.0, 15.0}}}));
  late.start_s = 100.0;
  ArmRecording brief = late;
  for (auto* columns : {&brief.position, &brief.velocity, &brief.effort}) {
    for (auto& column : *columns) column.resize(300);
  }
  const auto both = estimate_external_torque(identified().model, std::array{free_motion(5), brief, late});
  ASSERT_TRUE(both) << describe(both.error());
  const auto first = estimate_external_torque(identified().model, free_motion(5));
  const auto second = estimate_external_torque(identified().model, late);
  ASSERT_EQ(both->stretches, (std::vector<std::size_t>{0, first->time_s.size()}));
  EXPECT_EQ(both->torque_N_m.bottomRows(second->torque_N_m.rows()), second->torque_N_m);
  EXPECT_NEAR(both->left_out_s, 0.6, 1e-9);
  ASSERT_EQ(both->contacts.size(), 1U);
  EXPECT_NEAR(both->contacts.front().from_s, 103.0, 0.05);
  const auto alone = estimate_external_torque(identified().model, brief);
  ASSERT_FALSE(alone) << "nothing else is there";
  EXPECT_NE(describe(alone.error()).find("too short"), std::string::npos);
}

/// Counted in noise that is even up to the cutoff, a sum of sines of drawn phases.
TEST(ArmIdentification, FalseContactsAreAsOftenAsNoisePassesTheThreshold) {
  constexpr int sines = 100;
  constexpr double cutoff_Hz = 10.0, duration_s = 1000.0, step_s = 0.005, heights = 2.0;
  signal::Random random(7);
  std::array<double, sines> phase{};
  for (double& one : phase) one = 6.283185307179586 * random.uniform();
  const double rms = std::sqrt(0.5 * sines);
  int passed = 0;
  double before = 0.0;
  for (int i = 0; i * step_s < duration_s; ++i) {
    double sum = 0.0;
    for (int k = 0; k < sines; ++k) {
      // Frequencies that share no period within the duration.
      const double frequency_Hz = cutoff_Hz * (k + 0.5 + 0.3 * std::sin(12.9898 * k)) / sines;
      sum += std::cos(6.283185307179586 * frequency_Hz * i * step_s + phase[static_cast<std::size_t>(k)]);
    }
    sum /= rms;
    if (i > 0 && (std::fabs(sum) > heights) && std::fabs(before) <= heights) ++passed;
    before = sum;
  }
  ArmModel model{.head = {.joints = 1, .cutoff_Hz = cutoff_Hz}, .joints = Joints<ArmJointModel>(1)};
  model.joints[0].residual_rms_N_m = 0.1;
  model.joints[0].contact_threshold_N_m = 0.2;
  EXPECT_NEAR(false_contacts_per_hour(model), 3600.0 * passed / duration_s, 0.1 * 3600.0 * passed / duration_s);
}

TEST(ArmIdentification, AModelReadsBackAsItWasWritten) {
  const std::filesystem::path file = scratch_path();
  std::ofstream(file) << to_toml(identified().model, "made by a test");
  const auto back = load_arm_model(file);
  ASSERT_TRUE(back) << describe(back.error());
  EXPECT_EQ(to_toml(*back, "made by a test"), to_toml(identified().model, "made by a test"));
  std::ofstream(file) << "a = 1\n";
  EXPECT_FALSE(load_arm_model(file));
  std::filesystem::remove(file);
}

std::string refusal(const std::function<void(ArmRecording&)>& spoil) {
  ArmRecording recording = free_motion(1);
  spoil(recording);
  const auto found = identify_arm(std::array{recording}, names, believed(truth(), 3));
  return found ? "nothing" : describe(found.error());
}

TEST(ArmIdentification, RecordingsThatCannotBeTrustedAreRefusedWithTheReason) {
  const auto expect = [](const std::string& told, const std::vector<std::string>& words) {
    for (const std::string& word : words) EXPECT_NE(told.find(word), std::string::npos) << word << " in " << told;
  };
  expect(refusal([](ArmRecording& r) { std::swap(r.velocity[1], r.velocity[3]); }),
         {"j2", "j4", "velocity", "swapped"});
  expect(refusal([](ArmRecording& r) { std::swap(r.position, r.velocity); }), {"velocity", "not the slope"});
  expect(refusal([](ArmRecording& r) { std::swap(r.effort[1], r.effort[3]); }), {"j2", "j4", "swapped"});
  expect(refusal([](ArmRecording& r) { std::swap(r.effort[0], r.effort[1]); }), {"j1", "swapped"});
  expect(refusal([](ArmRecording& r) {
           for (double& value : r.effort[1]) value = -value;
         }),
         {"j2", "wrong sign"});
  expect(refusal([](ArmRecording& r) {
           for (double& value : r.effort[4]) value = 0.0;
         }),
         {"j5", "0 throughout"});
  expect(refusal([](ArmRecording& r) {
           for (double& value : r.position[2]) value = 0.3;
           for (double& value : r.velocity[2]) value = 0.0;
         }),
         {"j3", "hardly moves"});
  const auto cut = [](std::size_t samples) {
    return [samples](ArmRecording& r) {
      for (auto* columns : {&r.position, &r.velocity, &r.effort}) {
        for (auto& column : *columns) column.resize(samples);
      }
    };
  };
  expect(refusal(cut(200)), {"too short", "record at least"});
  expect(refusal(cut(700)), {"too short"});
}

class ArmFiles : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  /// The first second of a simulation, as text.
  static std::string table(const std::string& header, char separator, double time_offset_s = 0.0) {
    const ArmRecording& recording = free_motion(1);
    std::ostringstream text;
    text.precision(15);
    text << header;
    for (std::size_t i = 0; i < 500; ++i) {
      text << time_offset_s + static_cast<double>(i) / 500.0;
      for (const auto* columns : {&recording.position, &recording.velocity, &recording.effort}) {
        for (const auto& column : *columns) text << separator << column[i];
      }
      text << "\n";
    }
    return text.str();
  }
  Result<ArmRecording> read(const std::string& text, const ArmColumns& columns) {
    std::ofstream(file_) << text;
    return read_arm(file_, columns, names);
  }
  std::string complaint(const std::string& text, const ArmColumns& columns) {
    const auto recording = read(text, columns);
    return recording ? "nothing" : describe(recording.error());
  }
  static std::string header() {
    std::string text = "t [s]";
    for (const char* of : {"q", "dq", "tau"}) {
      for (int j = 1; j <= 7; ++j) text += std::string(",") + of + std::to_string(j);
    }
    return text + "\n";
  }
  const std::filesystem::path file_ = scratch_path().string() + ".csv";
};

TEST_F(ArmFiles, NamesNumbersAndRangesNameTheSameColumns) {
  const ArmColumns by_name{.time = "t", .position = "q1:q7", .velocity = "dq1,dq2:dq7", .effort = "tau1:tau7"};
  const auto named = read(table(header(), ','), by_name);
  ASSERT_TRUE(named) << describe(named.error());
  EXPECT_EQ(named->samples(), 500U);
  EXPECT_NEAR(named->sample_time.value, 0.002, 1e-12);
  for (const std::string& text : {table("", ','), table("", ' '), table("", '\t'), table("# comment\n", ';')}) {
    const auto plain = read(text, numbered);
    ASSERT_TRUE(plain) << describe(plain.error());
    EXPECT_EQ(plain->position, named->position);
    EXPECT_EQ(plain->effort, named->effort);
  }
  const auto without_velocity = read(table("", ','), {.time = "1", .position = "2:8", .effort = "16:22"});
  ASSERT_TRUE(without_velocity);
  EXPECT_TRUE(without_velocity->velocity.empty());
  // Seconds since 1970 leave the same steps.
  const auto late = read(table("", ',', 1.7e9), numbered);
  ASSERT_TRUE(late) << describe(late.error());
  EXPECT_NEAR(late->sample_time.value, 0.002, 1e-8);
  EXPECT_EQ(late->start_s, 1.7e9);
}

TEST_F(ArmFiles, WhatIsWrongWithAFileIsSaid) {
  const auto expect = [](const std::string& told, const std::vector<std::string>& words) {
    for (const std::string& word : words) EXPECT_NE(told.find(word), std::string::npos) << word << " in " << told;
  };
  const std::string good = table("", ',');
  const auto spoilt = [&](std::size_t line, const std::function<void(std::string&)>& spoil) {
    std::istringstream lines(good);
    std::string all;
    std::string text;
    for (std::size_t i = 1; std::getline(lines, text); ++i) {
      if (i == line) spoil(text);
      all += text.empty() ? "" : text + "\n";
    }
    return all;
  };
  ArmColumns six = numbered;
  six.position = "2:7";
  expect(complaint(good, six), {"--position", "6 columns", "7 joints"});
  ArmColumns beyond = numbered;
  beyond.effort = "16:23";
  expect(complaint(good, beyond), {"column 23", "22 columns"});
  ArmColumns unknown = numbered;
  unknown.effort = "torque";
  expect(complaint(table(header(), ','), unknown), {"'torque'"});
  expect(complaint(spoilt(30, [](std::string& line) { line.replace(line.find(',') + 1, 3, "nan"); }), numbered),
         {":30:", "'2'"});
  expect(complaint(spoilt(30, [](std::string& line) { line.replace(0, line.find(','), "0.001"); }), numbered),
         {"do not increase", "sample 2"});
  std::string pause = good;
  const std::size_t from = pause.find("\n0.2,");
  pause.erase(from, pause.find("\n0.3,") - from);
  expect(complaint(pause, numbered), {"nothing was recorded", "cut the file"});
  expect(read_arm("no/such.csv", numbered, names).error().message, {"does not exist"});
}

}  // namespace
}  // namespace tactus::arm_identification
