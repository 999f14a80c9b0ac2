#include <algorithm>
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
class ArmVerbs : public Command {
 protected:
  static std::string example(const std::string& name) { return std::string(TACTUS_RECORDING_FOLDER) + "/" + name; }
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
const std::vector<std::string> ArmVerbs::numbers{"--time",     "1",   "--position", "2:4",
                                                 "--velocity", "5:7", "--effort",   "8:10"};
const std::vector<std::string> ArmVerbs::names{"--time",     "time",
                                               "--position", "shoulder_1_rad,shoulder_2_rad,elbow_rad",
                                               "--velocity", "shoulder_1_rad_per_s:elbow_rad_per_s",
                                               "--effort",   "shoulder_1_N_m",
                                               "--effort",   "shoulder_2_N_m,elbow_N_m"};

TEST_F(ArmVerbs, an_arm_identified_in_free_motion_tells_when_it_is_pushed) {
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
  EXPECT_EQ(files(),
            (std::vector<std::string>{"results", "results/model.toml", "results/report.html", "results/results.json"}));

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

TEST_F(ArmVerbs, a_table_wants_its_columns_named_and_a_log_does_not) {
  const Outcome nameless = identify({example("arm-free-motion.csv")}, {"--time", "1", "--position", "2:4"});
  EXPECT_EQ(nameless.status, 2);
  EXPECT_NE(nameless.err.find("--effort: it is required for a table, as "), std::string::npos) << nameless.err;
  make_folder("log");
  const Outcome named = identify({"log"}, {"--time", "1"});
  EXPECT_EQ(named.status, 2);
  EXPECT_NE(named.err.find("--time: the log log tells by itself what is what: leave it out"), std::string::npos)
      << named.err;
}

TEST_F(ArmVerbs, a_file_without_a_header_and_several_files_are_read_as_one_with_it) {
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

TEST_F(ArmVerbs, wrong_requests_are_answered_with_place_and_remedy) {
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
  write("model.toml", "[arm]\njoints = 3\n");
  expect(tactus(with({"estimate", "torque", "free.csv", "--model", "model.toml"}, numbers)), {"model.toml", "joint_1"});
  EXPECT_EQ(tactus({"identify", "arm", "free.csv", "--urdf", example("three-joints.urdf")}).status, 2);
}

}  // namespace
}  // namespace tactus::cli
