// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"

namespace tactus::cli {
namespace {

using Words = std::vector<std::string>;

/// One bad request: the words after `tactus`, the exit status, and what the message must name.
struct Refusal {
  Words arguments;
  int status;
  Words named;
};

class WrongUse : public Command {
 protected:
  /// Status, one line on standard error with all that it must name, nothing on standard output, no file made.
  void expect(const Refusal& refusal) const {
    std::string request = "tactus";
    for (const std::string& word : refusal.arguments) request += " " + word;
    SCOPED_TRACE(request);
    const Words before = files();
    const Outcome outcome = tactus(refusal.arguments);
    EXPECT_EQ(outcome.status, refusal.status);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("tactus: ")) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_TRUE(outcome.err.ends_with('\n'));
    for (const std::string& part : refusal.named) {
      EXPECT_NE(outcome.err.find(part), std::string::npos) << "no '" << part << "' in: " << outcome.err;
    }
    EXPECT_EQ(files(), before);
  }

  /// A request to run what `toml` says. It also asks for files, of which none may appear.
  void expect_refused_file(const std::string& toml, const Words& named) const {
    const std::string file = write("bad.toml", toml);
    expect({{"run", file, "--out", "results"}, 2, named});
  }
  /// The quick experiment with further options.
  void expect_refused_options(Words options, int status, const Words& named) const {
    Words arguments{"run", quick_experiment(), "--out", "results"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    expect({arguments, status, named});
  }
};

TEST_F(WrongUse, WhatIsNoNumberOrNotInRange) {
  const std::string file = quick_experiment();
  for (const std::string value : {"nan", "-1", "inf", "1x", ""}) {
    const Words named{"'" + value + "' is not a number in [0 - "};
    expect({{"serve", "--port", "0", "--duration-s", value}, 2, {"--duration-s", named[0] + "1e+06]"}});
    expect({{"stability", "margins", file, "--uncertainty", value}, 2, {"--uncertainty", named[0] + "0.9]"}});
    expect({{"emulate", "inverse3", "--late-s", value}, 2, {"--late-s", named[0] + "10]"}});
  }
  expect({{"emulate", "damiao", "--fault", "silence:3@1"}, 2, {"--fault", "'silence:3@1': the motors go from 1 to 2"}});
  expect({{"run", TACTUS_EXPERIMENT_FOLDER "/arm-tapping.toml", "--realtime", "--device", "mine"},
          2,
          {"--device", "arms are those of a rig file, whose name ends in .toml"}});
}

TEST_F(WrongUse, NoCommandAnUnknownOneAndAnUnknownOption) {
  expect({{}, 2, {"command is required", "tactus --help"}});
  expect({{"rum"}, 2, {"rum", "tactus --help"}});
  expect({{"--verbose"}, 2, {"--verbose", "tactus --help"}});
  expect({{"run"}, 2, {"EXPERIMENT is required"}});
  expect({{"run", quick_experiment(), "another.toml"}, 2, {"another.toml"}});
  expect({{"run", quick_experiment(), "--verbose"}, 2, {"--verbose"}});
  expect({{"run", quick_experiment(), "--set"}, 2, {"--set", "KEY=VALUE"}});
  expect({{"schema", "grasping"}, 2, {"'grasping'", "tapping, force-display"}});
  expect({{"schema", "tapping", "--verbose"}, 2, {"--verbose"}});
}

TEST_F(WrongUse, APlugInThatCannotBeLoadedBeforeAndAfterTheCommand) {
  expect({{"--plugin", "no.so", "device", "check", "rig.toml"}, 2, {"no.so", "cannot be loaded"}});
  expect({{"device", "check", "rig.toml", "--plugin", "no.so"}, 2, {"no.so", "cannot be loaded"}});
  expect({{"device", "check", "--plugin=no.so", "rig.toml"}, 2, {"no.so", "cannot be loaded"}});
  expect({{"device", "check", "rig.toml", "--plugin"}, 2, {"--plugin"}});
}

TEST_F(WrongUse, AnOldNameOfAnOptionIsRefusedWithItsNewOne) {
  expect({{"serve", "--duration", "1"}, 2, {"'--duration' is now called --duration-s"}});
  expect({{"device", "watch", "rig.toml", "--for", "1"}, 2, {"'--for' is now called --duration-s"}});
}

TEST_F(WrongUse, AFileThatIsMissingAFolderOrEmpty) {
  expect({{"run", "missing.toml", "--out", "results"}, 2, {"missing.toml", "no such file", "check the path"}});
  expect({{"run", ".", "--out", "results"}, 2, {"folder", "give a TOML file"}});
  expect_refused_file("", {"bad.toml", "empty"});
}

TEST_F(WrongUse, BrokenToml) {
  expect_refused_file("[task]\nkind = \"tapping\n", {"bad.toml:2:"});
  expect_refused_file("[task\n", {"bad.toml:1:"});
  expect_refused_file("[task]\nkind = \"tapping\"\nkind = \"tapping\"\n", {"bad.toml:3:", "kind"});
}

TEST_F(WrongUse, AnUnknownOrMissingKind) {
  expect_refused_file("[task]\nkind = \"grasping\"\n", {"bad.toml:2:8", "task.kind", "'grasping'", "tapping"});
  expect_refused_file("[control]\nforce_gain = 1.0\n", {"bad.toml", "task.kind", "needed"});
}

TEST_F(WrongUse, AnUnknownKeyNamesTheNearest) {
  expect_refused_file("[task]\nkind = \"tapping\"\n[control]\nforce_gian = 3.0\n",
                      {"bad.toml:4:1", "control.force_gian", "did you mean force_gain?"});
  expect_refused_file("[task]\nkind = \"tapping\"\n[contrl]\nforce_gain = 3.0\n",
                      {"bad.toml:3:2", "contrl", "did you mean control?"});
}

TEST_F(WrongUse, AValueOfTheWrongTypeOrOutOfBounds) {
  const std::string start = "[task]\nkind = \"tapping\"\n";
  expect_refused_file(start + "[control]\nforce_gain = \"high\"\n",
                      {"bad.toml:4:14", "control.force_gain", "\"high\"", "number", "at least 0 and at most 1000"});
  expect_refused_file(start + "taps = 1.5\n", {"bad.toml:3:8", "task.taps", "1.5", "whole number"});
  expect_refused_file(start + "[control]\ncancellation = \"maybe\"\n",
                      {"bad.toml:4:16", "control.cancellation", "maybe", "off", "on"});
  expect_refused_file(start + "[control]\nforce_gain = 1e9\n",
                      {"bad.toml:4:14", "control.force_gain", "1e+09", "at most 1000"});
  expect_refused_file(start + "[control]\nforce_gain = nan\n", {"bad.toml:4:14", "control.force_gain", "nan"});
  expect_refused_file(start + "[environment]\nstiffness_N_per_m = inf\n",
                      {"bad.toml:4:21", "environment.stiffness_N_per_m", "inf", "N/m"});
  expect_refused_file(start + "[master.mechanism.motor]\nmass_kg = -0.0075\n",
                      {"bad.toml:4:11", "master.mechanism.motor.mass_kg", "-0.0075 kg", "greater than 0 kg"});
}

TEST_F(WrongUse, ValuesThatContradictOneAnother) {
  const std::string start = "[task]\nkind = \"tapping\"\n";
  expect_refused_file(start + "slowest_m_per_s = 0.5\n", {"task.fastest_m_per_s", "0.08", "0.5", "raise one"});
  expect_refused_file(start + "[servo]\nrate_Hz = 5000.0\ncomputation_delay_s = 2e-4\n",
                      {"bad.toml:5:23", "servo.computation_delay_s", "less than a control cycle"});
  expect_refused_file(start + "[environment]\nstiffness_N_per_m = 1e7\n[slave.mechanism.tip]\nmass_kg = 1e-5\n",
                      {"bad.toml:4:21", "environment.stiffness_N_per_m", "step finer"});
}

TEST_F(WrongUse, SetThatIsNoAssignmentOrSetsWhatCannotBe) {
  expect_refused_options({"--set", "control.force_gain"}, 2, {"--set control.force_gain", "key=value"});
  expect_refused_options({"--set", "=3"}, 2, {"--set =3", "is no key"});
  expect_refused_options({"--set", "control=3"}, 2, {"--set control=3", "section"});
  expect_refused_options({"--set", "control.force_gain=-1"}, 2,
                         {"--set control.force_gain=-1", "at least 0 and at most 1000"});
  expect_refused_options({"--set", "control.force_gain=nan"}, 2, {"--set control.force_gain=nan", "nan"});
  expect_refused_options({"--set", "control.force_gian=1"}, 2, {"did you mean force_gain?"});
  expect_refused_options({"--set", "task.kind=grasping"}, 2, {"--set task.kind=grasping", "tapping, force-display"});
}

TEST_F(WrongUse, VaryThatIsNoListOrVariesWhatCannotBe) {
  expect_refused_options({"--vary", "control.force_gain"}, 2, {"--vary control.force_gain", "key=value,value"});
  expect_refused_options({"--vary", "control.force_gain=1,,3"}, 2, {"a value is empty"});
  expect_refused_options({"--vary", "=1,3"}, 2, {"no key"});
  expect_refused_options({"--vary", "control.force_gain=1,-3"}, 2,
                         {"--vary control.force_gain=-3", "at least 0 and at most 1000"});
  expect_refused_options({"--vary", "control.cancellation=off,perhaps"}, 2,
                         {"--vary control.cancellation=perhaps", "on"});
  expect_refused_options({"--vary", "control.force_gian=1,3"}, 2, {"--vary control.force_gian=1", "force_gain?"});
  expect_refused_options({"--vary", "control.force_gain=1", "--vary", "control.force_gain=3"}, 2,
                         {"--vary", "control.force_gain", "twice", "one --vary"});
}

TEST_F(WrongUse, ADeviceThatTheProgramDoesNotBring) {
  expect_refused_options({"--device", "carriage"}, 2, {"--device", "--site"});
  expect_refused_options({"--site", "slave", "--peer", "127.0.0.1:1", "--unencrypted", "--device", "carriage"}, 2,
                         {"--device", "'carriage' is no device", "register", "examples/own-device"});
}

TEST_F(WrongUse, ARecordingThatIsMissingOrHasNoSuchColumn) {
  write("impact.csv", "time_s,force_N,speed_m_per_s\n0,0,0\n0.001,1,0\n0.002,0,0\n");
  const auto file = write("display.toml", "[task]\nkind = \"force-display\"\n[profile]\nduration_s = 0.005\n");
  const auto with = [&](Words options) {
    Words arguments{"run", file, "--out", "results"};
    for (const std::string& option : options) arguments.insert(arguments.end(), {"--set", option});
    return arguments;
  };
  expect({with({"profile.file=nowhere.csv"}), 2, {"profile.file", "nowhere.csv", "does not exist"}});
  expect({with({"profile.file=impact.csv", "profile.variable=farce"}),
          2,
          {"--set profile.variable=farce", "profile.variable", "'farce'", "did you mean 'force'"}});
  expect({with({"profile.file=impact.csv", "profile.variable=force", "profile.start_s=5"}),
          2,
          {"--set profile.start_s=5", "profile.start_s", "recording of 0.003 s"}});
  write("broken.csv", "time_s,force_N\n0,0\n0.001,many\n");
  expect({with({"profile.file=broken.csv", "profile.variable=force"}), 2, {"broken.csv:3", "many"}});
  write("broken.mat", "no MATLAB file");
  expect({with({"profile.file=broken.mat", "profile.variable=force"}), 2, {"broken.mat"}});
}

TEST_F(WrongUse, AnOutThatCannotBeWrittenIsAFailureOfTheJobAndKnownBeforeIt) {
  write("occupied", "a file");
  // As root no folder is closed, so these are places where nobody can make one.
  for (const std::string place : {"occupied", "occupied/below", "/proc/results", "/dev/null/results"}) {
    expect({{"run", quick_experiment(), "--out", place, "--set", "task.taps=100000"}, 1, {"'", "folder"}});
  }
  EXPECT_EQ(content("occupied"), "a file");
  expect({{"run", quick_experiment(), "--out", ""}, 2, {"--out", "no folder is named"}});
}

TEST_F(WrongUse, AFolderInThePlaceOfAResultLeavesTheOthersWhole) {
  make_folder("results/report.html");
  const Outcome outcome = tactus({"run", quick_experiment(), "--out", "results"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("results/report.html"), std::string::npos) << outcome.err;
  // The finished taps stay until the results are written; no half-written result does.
  const auto partial = [this] {
    std::vector<std::string> found;
    for (const std::string& file : files()) {
      if (file.find(".partial") != std::string::npos) found.push_back(file);
    }
    return found;
  };
  EXPECT_EQ(partial(), std::vector<std::string>{"results/tasks.partial"});
  EXPECT_TRUE(content("results/figure-1.svg").ends_with("</svg>\n"));
  std::filesystem::remove(folder() / "results/report.html");
  EXPECT_EQ(tactus({"run", quick_experiment(), "--out", "results", "--overwrite"}).status, 0);
  EXPECT_EQ(partial(), std::vector<std::string>());
}

}  // namespace
}  // namespace tactus::cli
