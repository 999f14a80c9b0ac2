// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/cancellation_file.hpp>
#include <tactus/data/configuration/toml_writer.hpp>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::configuration {
namespace {

/// A model that differs from the default, with every key.
control::MasterModel model_of_a_lever() {
  control::MasterModel model;
  model.motor = {.mass_kg = 0.0196, .friction_N = 0.053};
  model.hand.damping_N_s_per_m = 23.0;
  return model;
}

std::string text_of(control::MasterModel model) { return to_toml(bind(model, "control.model")); }

std::filesystem::path write(const std::string& text) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "cancellation_file";
  std::filesystem::create_directories(folder);
  auto file = folder / (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".toml");
  std::ofstream(file) << text;
  return file;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

TEST(CancellationFile, HasTheModelAndTheMethod) {
  const auto params =
      read_cancellation(write("[control]\ncancellation_friction = \"at-rest\"\n" + text_of(model_of_a_lever())));
  ASSERT_TRUE(params) << describe(params.error());
  EXPECT_EQ(params->model.master.motor.mass_kg, 0.0196);
  EXPECT_EQ(params->model.master.motor.friction_N, 0.053);
  EXPECT_EQ(params->model.master.hand.damping_N_s_per_m, 23.0);
  EXPECT_EQ(params->model.friction, control::ModelFriction::at_rest);
  EXPECT_TRUE(control::Cancellation::make(*params, Seconds{200e-6}));
}

TEST(CancellationFile, WithoutAnyOneKeyOfTheModelIsRefused) {
  const std::vector<std::string> lines = lines_of(text_of(model_of_a_lever()));
  int keys = 0;
  for (std::size_t left = 0; left < lines.size(); ++left) {
    if (lines[left].find(" = ") == std::string::npos || lines[left].starts_with("linear_hand_stiffening") ||
        lines[left].starts_with("guard_m")) {
      continue;
    }
    std::string text;
    for (std::size_t i = 0; i < lines.size(); ++i) text += i == left ? "" : lines[i] + "\n";
    const auto file = write(text);
    const auto params = read_cancellation(file);
    ASSERT_FALSE(params) << lines[left];
    EXPECT_EQ(params.error().code, ErrorCode::missing);
    EXPECT_EQ(params.error().place, file.string());
    EXPECT_TRUE(params.error().parameter.ends_with("." + lines[left].substr(0, lines[left].find(' ')))) << lines[left];
    ++keys;
  }
  EXPECT_GE(keys, 14);
  EXPECT_FALSE(read_cancellation(write("")));
  EXPECT_FALSE(read_cancellation("no-such-model.toml"));
}

TEST(CancellationFile, AWrongKeyOrValueIsRefusedWithItsPlace) {
  const auto unknown = read_cancellation(write(text_of(model_of_a_lever()) + "[control.model.lever]\nmass_kg = 1.0\n"));
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::unknown_key);
  const auto document = Document::parse("[control.model.motor]\nmass_kg = 0.02\n", "model.toml");
  ASSERT_TRUE(document);
  const Error located = locate_cancellation(
      *document,
      {.code = ErrorCode::out_of_bounds, .parameter = "model.master.motor.mass_kg", .message = "m", .place = {}});
  EXPECT_EQ(located.parameter, "control.model.motor.mass_kg");
  EXPECT_EQ(located.place, "model.toml:2:11");
}

}  // namespace
}  // namespace tactus::configuration
