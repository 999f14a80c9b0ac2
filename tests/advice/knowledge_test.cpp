// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/knowledge.hpp>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::advice {
namespace knowledge_test {

using experiments::TappingParams;
using identification::FoundParameter;

FoundParameter found(std::string name, double value, double factor) {
  return {.name = std::move(name), .unit = "", .value = value, .interval_95 = {value / factor, value * factor}};
}

/// Two masses that are known well as a sum and badly apart.
Knowledge two_masses(const Conditions& given = {}) {
  const std::vector<FoundParameter> both{found("motor.mass_kg", 0.008, 1.2), found("drum.mass_kg", 0.011, 1.2)};
  return Knowledge::identified(both, std::vector{1.0, -0.95, -0.95, 1.0}, given);
}

struct Logs {
  std::vector<double> motor, drum;
};

Logs draw_many(const Knowledge& knowledge, const Known& known) {
  Logs logs;
  for (std::uint64_t draw = 1; draw <= 2000; ++draw) {
    const TappingParams rig = knowledge.drawn(TappingParams{}, draw, known);
    logs.motor.push_back(std::log(rig.master.mechanism.motor.mass_kg / 0.008));
    logs.drum.push_back(std::log(rig.master.mechanism.drum.mass_kg / 0.011));
  }
  return logs;
}

double mean_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum / static_cast<double>(a.size());
}

TEST(Knowledge, DrawsHaveTheIntervalAndTheCorrelationThatWereFound) {
  const Logs logs = draw_many(two_masses(), {});
  const double deviation = std::log(1.2) / 1.96;
  EXPECT_NEAR(std::sqrt(mean_product(logs.motor, logs.motor)), deviation, 0.05 * deviation);
  EXPECT_NEAR(std::sqrt(mean_product(logs.drum, logs.drum)), deviation, 0.05 * deviation);
  EXPECT_NEAR(mean_product(logs.motor, logs.drum) / (deviation * deviation), -0.95, 0.05);
}

TEST(Knowledge, WhatIsKnownExactlyLeavesOfTheOthersWhatItDoesNotTell) {
  const Logs logs = draw_many(two_masses(), {.one = 0});
  EXPECT_EQ(mean_product(logs.motor, logs.motor), 0.0);
  const double left = std::log(1.2) / 1.96 * std::sqrt(1.0 - 0.95 * 0.95);  // of a normal one beside what is known
  EXPECT_NEAR(std::sqrt(mean_product(logs.drum, logs.drum)), left, 0.05 * left);
  const Logs all = draw_many(two_masses(), {.all = true});
  EXPECT_EQ(mean_product(all.drum, all.drum), 0.0);
}

TEST(Knowledge, TheFirstDrawIsWhatIsBelievedAndTheModelIsLeftAlone) {
  const std::vector<FoundParameter> some{
      found("motor.mass_kg", 0.008, 1.2),           found("linkage.slip_deflection_m", 6.5e-5, 1.5),
      found("amplifier.lag_s", 1.5e-4, 1.1),        found("operator.damping_N_s_per_m", 30.0, 1.3),
      found("operator.reaction_time_s", 0.15, 1.1), found("linkage.loop_area_J", 1e-5, 1.1)};
  TappingParams believed;
  believed.servo.computation_delay_s = 1e-4;
  const Knowledge knowledge = Knowledge::identified(some, {}, {});
  EXPECT_EQ(knowledge.parameters().size(), 5U) << "an area is no parameter of a rig";
  const TappingParams rig = knowledge.drawn(believed, 0);
  EXPECT_NEAR(rig.master.mechanism.motor.mass_kg, 0.008, 1e-15);
  EXPECT_NEAR(rig.master.mechanism.linkage.slip_deflection_m, 1e-4, 1e-12) << "the laws differ in what it means";
  EXPECT_NEAR(rig.master.amplifier.bandwidth_Hz, 1.0 / (2.0 * M_PI * 5e-5), 1e-6);
  EXPECT_NEAR(rig.person.grip.damping_N_s_per_m, 30.0, 1e-12);
  EXPECT_NEAR(rig.person.correction.reaction_time_s, 0.15 - 1.0 / (2.0 * M_PI * 5.0), 1e-12);
  EXPECT_EQ(rig.control.model.motor.mass_kg, believed.control.model.motor.mass_kg);
}

TEST(Knowledge, WhatIsGivenIsNeitherDrawnNorMoved) {
  const Knowledge knowledge = two_masses({"master.mechanism.motor.mass_kg"});
  ASSERT_EQ(knowledge.parameters().size(), 1U);
  EXPECT_EQ(knowledge.drawn(TappingParams{}, 7).master.mechanism.motor.mass_kg,
            TappingParams{}.master.mechanism.motor.mass_kg);
}

TEST(Knowledge, AStatedErrorMovesTheModelAndNoFurtherThanStated) {
  const Knowledge knowledge = Knowledge::wrong_model(0.2);
  double largest = 0.0;
  for (std::uint64_t draw = 1; draw < 500; ++draw) {
    const TappingParams rig = knowledge.drawn(TappingParams{}, draw);
    largest = std::max(largest, std::fabs(rig.task.mismatch.mass - 1.0));
    EXPECT_EQ(rig.master.mechanism.motor.mass_kg, TappingParams{}.master.mechanism.motor.mass_kg);
  }
  EXPECT_LE(largest, 0.2);
  EXPECT_GT(largest, 0.19);
  EXPECT_EQ(knowledge.drawn(TappingParams{}, 0).task.mismatch.mass, 1.0);
  EXPECT_TRUE(Knowledge::wrong_model(0.0).parameters().empty());
}

TEST(Knowledge, EveryDrawHasTapsOfItsOwnAndTheSameOnesEachTime) {
  const Knowledge knowledge = two_masses();
  const TappingParams one = knowledge.drawn(TappingParams{}, 1), two = knowledge.drawn(TappingParams{}, 2);
  EXPECT_NE(one.task.seed, two.task.seed);
  EXPECT_EQ(one.task.seed, knowledge.drawn(TappingParams{}, 1).task.seed);
  EXPECT_EQ(one.master.mechanism.motor.mass_kg, knowledge.drawn(TappingParams{}, 1).master.mechanism.motor.mass_kg);
}

TEST(Knowledge, FitsTheModelOfTheSameIdentificationAlone) {
  const std::vector<FoundParameter> some{found("amplifier.gain", 1.05, 1.01), found("motor.mass_kg", 0.0084, 1.2)};
  const Knowledge knowledge = Knowledge::identified(some, {}, {});
  control::MasterModel model;
  model.motor.mass_kg = 0.008;  // as a commanded newton sees it
  EXPECT_FALSE(knowledge.fits(model));
  model.motor.mass_kg = 0.0084;
  const Check error = knowledge.fits(model);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->parameter, "control.model.motor.mass_kg");
}

TEST(Knowledge, AFileThatIsNoIdentificationIsRefused) {
  for (const char* text : {"", "{", "[]", "{\"runs\": []}", "{\"parameters\": [{\"name\": \"motor.mass_kg\"}]}",
                           "{\"parameters\": [{\"name\": \"motor.mass_kg\", \"value\": 1, \"interval_95\": [1, 2]}], "
                           "\"correlation\": [[1, 0]]}"}) {
    const auto file = scratch_path();
    std::ofstream(file) << text;
    const auto knowledge = Knowledge::read(file, {});
    ASSERT_FALSE(knowledge) << text;
    EXPECT_EQ(knowledge.error().code, ErrorCode::syntax);
    EXPECT_EQ(knowledge.error().place, file.string());
    std::filesystem::remove(file);
  }
  EXPECT_EQ(Knowledge::read("none.json", {}).error().code, ErrorCode::missing);
}

}  // namespace knowledge_test
}  // namespace tactus::advice
