// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using ArmJson = nlohmann::json;

/// On the recordings of a simulated arm of three joints that come with the project.
class ArmCommands : public Command {
 protected:
  static std::string example(const std::string& name) {
    return std::string(TACTUS_EXAMPLE_FOLDER "/recordings") + "/" + name;
  }
  static std::string example_text(const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(example(name)).rdbuf();
    return text.str();
  }
  /// The free motion without its comments and its header.
  static std::string headless() {
    const std::string text = example_text("arm-free-motion.csv");
    return text.substr(text.find('\n', text.find("time_s")) + 1);
  }
  static std::vector<std::string> with(std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] Outcome identify(const std::vector<std::string>& files, const std::vector<std::string>& more) const {
    return tactus(with(with({"identify", "arm"}, files),
                       with({"--urdf", example("three-joints.urdf"), "--gravity", "0,-9.81,0"}, more)));
  }
  static const std::vector<std::string> numbers;
  static const std::vector<std::string> names;
};
const std::vector<std::string> ArmCommands::numbers{"--time",     "1",   "--position", "2:4",
                                                    "--velocity", "5:7", "--effort",   "8:10"};
const std::vector<std::string> ArmCommands::names{"--time",     "time",
                                                  "--position", "shoulder_1_rad,shoulder_2_rad,elbow_rad",
                                                  "--velocity", "shoulder_1_rad_per_s:elbow_rad_per_s",
                                                  "--effort",   "shoulder_1_N_m",
                                                  "--effort",   "shoulder_2_N_m,elbow_N_m"};

TEST_F(ArmCommands, an_arm_identified_in_free_motion_tells_when_it_is_pushed) {
  const Outcome identified = identify({example("arm-free-motion.csv")}, with(names, {"--json", "--out", "results"}));
  ASSERT_EQ(identified.status, 0) << identified.err;
  const ArmJson model = ArmJson::parse(identified.out);
  ASSERT_EQ(model["joints"].size(), 3U);
  EXPECT_EQ(model["joints"][2]["name"], "elbow");
  for (const ArmJson& joint : model["joints"]) {
    EXPECT_NEAR(joint["relative"].get<double>(),
                joint["residual_rms"].get<double>() / joint["effort_rms"].get<double>(), 1e-12);
    EXPECT_LT(joint["relative"].get<double>(), 0.03);
    EXPECT_LT(joint["held_out_relative"].get<double>(), 1.05 * joint["least_squares_held_out_relative"].get<double>());
  }
  EXPECT_EQ(files(), (std::vector<std::string>{"results", "results/arm.urdf", "results/armatures.toml",
                                               "results/model.toml", "results/report.html", "results/results.json"}));

  const Outcome estimated = tactus(with(
      {"estimate", "torque", example("arm-pushed.csv"), "--model", "results/model.toml", "--json", "--out", "torque"},
      numbers));
  ASSERT_EQ(estimated.status, 0) << estimated.err;
  const ArmJson torque = ArmJson::parse(estimated.out);
  EXPECT_EQ(torque["joints"][0]["name"], "shoulder_1");
  for (const ArmJson& joint : torque["joints"]) EXPECT_LT(joint["relative"].get<double>(), 0.04);
  ASSERT_EQ(torque["contacts"].size(), 1U);
  EXPECT_NEAR(torque["contacts"][0]["from_s"].get<double>(), 3.0, 0.05);
  EXPECT_NEAR(torque["contacts"][0]["to_s"].get<double>(), 3.8, 0.05);
  EXPECT_FALSE(torque["contacts"][0]["joints"].empty());
  EXPECT_NE(content("torque/external_torque.csv").find("\"elbow_N_m\""), std::string::npos);

  const Outcome free = tactus(
      with({"estimate", "torque", example("arm-free-motion.csv"), "--model", "results/model.toml", "--json"}, names));
  ASSERT_EQ(free.status, 0) << free.err;
  EXPECT_TRUE(ArmJson::parse(free.out)["contacts"].empty());
}

TEST_F(ArmCommands, what_a_recording_does_not_tell_is_named) {
  // Two seconds and a half; the first link's mass never moves.
  const std::string text = headless();
  write("short.csv", text.substr(0, text.find("\n2.50,") + 1));
  const Outcome poor = identify({"short.csv"}, numbers);
  ASSERT_EQ(poor.status, 0) << poor.err;
  const std::size_t at = poor.out.find("Not determined, so as in the URDF");
  ASSERT_NE(at, std::string::npos) << poor.out;
  const std::string line = poor.out.substr(poor.out.find("shoulder_1", at), 60);
  EXPECT_TRUE(line.starts_with("shoulder_1  mass, ")) << line;
  EXPECT_NE(poor.out.find("`identify excitation` designs a motion that determines more"), std::string::npos);
}

TEST_F(ArmCommands, a_motion_that_tells_most_is_left_as_a_table_within_the_limits) {
  const std::vector<std::string> words{"identify",  "excitation", "--urdf",       example("three-joints.urdf"),
                                       "--gravity", "0,-9.81,0",  "--duration-s", "6",
                                       "--rate-Hz", "50"};
  const Outcome made = tactus(with(words, {"--above-m", "0.02", "--json", "--out", "motion"}));
  ASSERT_EQ(made.status, 0) << made.err;
  const ArmJson found = ArmJson::parse(made.out);
  EXPECT_GT(found["designed"]["information_nats"], found["random"]["information_nats"]);
  EXPECT_GE(found["clearance_m"].get<double>(), 0.0);
  EXPECT_EQ(found["seed"], 1);
  std::istringstream table(content("motion/trajectory.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_TRUE(line.starts_with(R"(time_s,"shoulder_1_rad","shoulder_2_rad","elbow_rad","shoulder_1_rad_per_s",)"))
      << line;
  int rows = 0;
  while (std::getline(table, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream values(line);
    double time_s = 0.0;
    double position = 0.0;
    values >> time_s;
    EXPECT_NEAR(time_s, 0.02 * rows, 1e-6);
    for (int j = 0; j < 3; ++j) {
      values >> position;
      EXPECT_LE(std::fabs(position), 0.7 * 2.5);
    }
    ++rows;
  }
  EXPECT_EQ(rows, 301);
  const Outcome high = tactus(with(words, {"--above-m", "3"}));
  EXPECT_EQ(high.status, 2);
  EXPECT_NE(high.err.find("mm outside of the box"), std::string::npos) << high.err;
  const Outcome two = tactus(with(words, {"--noise-N-m", "0.1,0.2"}));
  EXPECT_EQ(two.status, 2);
  EXPECT_NE(two.err.find("--noise-N-m: 2 numbers, but the arm has 3 joints"), std::string::npos) << two.err;
}

TEST_F(ArmCommands, a_table_wants_its_columns_named_and_a_log_does_not) {
  const Outcome nameless = identify({example("arm-free-motion.csv")}, {"--time", "1", "--position", "2:4"});
  EXPECT_EQ(nameless.status, 2);
  EXPECT_NE(nameless.err.find("--effort: it is required for a table, as "), std::string::npos) << nameless.err;
  make_folder("log");
  const Outcome named = identify({"log"}, {"--time", "1"});
  EXPECT_EQ(named.status, 2);
  EXPECT_NE(named.err.find("--time: the log log names its own columns: leave it out"), std::string::npos) << named.err;
}

TEST_F(ArmCommands, a_file_without_a_header_and_several_files_are_read_as_one_with_it) {
  const Outcome named = identify({example("arm-free-motion.csv")}, with(names, {"--json"}));
  const std::string text = headless();
  write("whole.txt", text);
  const Outcome numbered = identify({"whole.txt"}, with(numbers, {"--json"}));
  ASSERT_EQ(numbered.status, 0) << numbered.err;
  EXPECT_EQ(ArmJson::parse(numbered.out)["joints"], ArmJson::parse(named.out)["joints"]);
  std::string blanks = text;
  std::replace(blanks.begin(), blanks.end(), ',', ' ');
  write("blanks.txt", blanks);
  EXPECT_EQ(ArmJson::parse(identify({"blanks.txt"}, with(numbers, {"--json"})).out)["joints"],
            ArmJson::parse(named.out)["joints"]);

  const std::size_t middle = text.find("\n6.00,") + 1;
  write("first.csv", text.substr(0, middle));
  write("second.csv", text.substr(middle));
  const Outcome both = identify({"first.csv", "second.csv"}, with(numbers, {"--json"}));
  ASSERT_EQ(both.status, 0) << both.err;
  const ArmJson joints = ArmJson::parse(both.out)["joints"];
  for (const ArmJson& joint : joints) EXPECT_LT(joint["relative"].get<double>(), 0.03);
}

TEST_F(ArmCommands, wrong_requests_are_answered_with_place_and_remedy) {
  write("free.csv", headless());
  const auto expect = [](const Outcome& outcome, const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " in " << outcome.err;
    }
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  expect(identify({"free.csv"}, {"--time", "1", "--position", "2:3", "--effort", "8:10"}), {"free.csv", "2 columns"});
  expect(identify({"free.csv"}, {"--time", "1", "--position", "5:7", "--velocity", "2:4", "--effort", "8:10"}),
         {"velocity", "not the slope"});
  expect(identify({"free.csv"}, {"--time", "1", "--position", "2:4", "--effort", "8:11"}), {"column 11", "10 columns"});
  expect(identify({"none.csv"}, numbers), {"none.csv", "does not exist"});
  expect(tactus(with({"identify", "arm", "free.csv", "--urdf", "none.urdf"}, numbers)), {"none.urdf"});
  write("cut.urdf", example_text("three-joints.urdf").substr(0, 900));
  expect(tactus(with({"identify", "arm", "free.csv", "--urdf", "cut.urdf"}, numbers)), {"cut.urdf:", "cut off"});
  const auto with_option = [&](const Words& option) { return identify({"free.csv"}, with(numbers, option)); };
  expect(with_option({"--reverse", "wrist"}), {"--reverse", "'wrist'", "elbow"});
  expect(with_option({"--payload", "0.5,0.1"}), {"--payload", "2 numbers", "KG,X,Y,Z"});
  expect(with_option({"--payload", "-1"}), {"--payload", "-1 kg", "above 0"});
  expect(with_option({"--payload", "nan"}), {"--payload"});
  expect(with_option({"--payload", "1,0,0,99"}), {"--payload", "99 m", "10 m"});
  write("model.toml", "[arm]\njoints = 3\n");
  expect(tactus(with({"estimate", "torque", "free.csv", "--model", "model.toml"}, numbers)), {"model.toml", "joint_1"});
  EXPECT_EQ(tactus({"identify", "arm", "free.csv", "--urdf", example("three-joints.urdf")}).status, 2);
}

}  // namespace
}  // namespace tactus::cli
