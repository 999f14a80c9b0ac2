// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"

namespace tactus::cli {
namespace {

using Words = std::vector<std::string>;
namespace fs = std::filesystem;

class Overwrite : public Command {
 protected:
  void expect_refusal(const Words& arguments, const Words& told) const {
    const Words before = files();
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments.front() << ": " << outcome.err;
    for (const std::string& words : told) EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(files(), before) << arguments.front();
  }
  [[nodiscard]] bool left(const std::string& file) const { return fs::exists(folder() / file); }
};

TEST_F(Overwrite, AFinishedRunStandsUntilAPersonAsksToReplaceIt) {
  const std::string file = quick_experiment();
  ASSERT_EQ(tactus({"run", file, "--out", "results"}).status, 0);
  const std::string report = content("results/report.html"), log = content("results/log/log.mcap");
  const Words again{"run", file, "--out", "results", "--set", "control.force_gain=3"};
  expect_refusal(again, {"--out", "'results/figure-1.svg'", "name another folder", "--overwrite"});
  expect_refusal({"stability", "margins", file, "--out", "results"}, {"--overwrite"});
  EXPECT_EQ(content("results/report.html"), report);
  EXPECT_EQ(content("results/log/log.mcap"), log);

  Words replace = again;
  replace.emplace_back("--overwrite");
  const Outcome outcome = tactus(replace);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(content("results/report.html"), report);
  EXPECT_NE(content("results/log/log.mcap"), log);
}

TEST_F(Overwrite, NothingOfTheEarlierRunStaysBesideTheNewOneAndWhatIsNotOfARunIsKept) {
  const std::string file = quick_experiment();
  ASSERT_EQ(tactus({"run", file, "--out", "results"}).status, 0);
  for (const char* name : {"results/figure-12.svg", "results/log/log_3.mcap"}) write(name, "of a longer run");
  for (const char* name : {"results/notes.txt", "results/model.toml", "results/log/mine.csv"}) write(name, "mine");
  ASSERT_EQ(tactus({"stability", "margins", file, "--out", "results", "--overwrite"}).status, 0);
  for (const char* name :
       {"results/log/log.mcap", "results/log/metadata.yaml", "results/figure-12.svg", "results/log/log_3.mcap"}) {
    EXPECT_FALSE(left(name)) << name;
  }
  for (const char* name : {"results/notes.txt", "results/model.toml", "results/log/mine.csv"}) {
    EXPECT_EQ(content(name), "mine") << name;
  }
  EXPECT_TRUE(left("results/report.html"));
}

TEST_F(Overwrite, ARequestThatIsWrongReplacesNothing) {
  const std::string file = quick_experiment();
  ASSERT_EQ(tactus({"run", file, "--out", "results"}).status, 0);
  for (const Words& more : {Words{"--set", "task.taps=-1"}, Words{"--realtime", "--set", "task.taps=1001"}}) {
    Words words{"run", file, "--out", "results", "--overwrite"};
    words.insert(words.end(), more.begin(), more.end());
    expect_refusal(words, {"task.taps"});
  }
  EXPECT_TRUE(left("results/report.html"));
}

TEST_F(Overwrite, InRealTimeTheOldReportIsGoneBeforeTheNewLogBegins) {
  const std::string file = quick_experiment();
  ASSERT_EQ(tactus({"run", file, "--out", "results"}).status, 0);
  const std::string report = content("results/report.html");
  const Words real{"run",   file,     "--realtime", "--set", "servo.rate_Hz=1000", "--set", "plant.longest_step_s=5e-5",
                   "--out", "results"};
  expect_refusal(real, {"--overwrite"});
  Words replace = real;
  replace.emplace_back("--overwrite");
  const Outcome outcome = tactus(replace);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(content("results/report.html"), report);
  EXPECT_EQ(tactus({"replay", "results/log", "--check"}).status, 0) << "the log is of the new run";
}

TEST_F(Overwrite, ALinkIsNeverFollowed) {
  const std::string file = quick_experiment();
  make_folder("elsewhere/log");
  write("elsewhere/precious", "kept");
  fs::create_directory_symlink("elsewhere", folder() / "link");
  for (const char* name : {"link", "link/", "link/."}) {
    for (const Words& more : {Words{}, Words{"--overwrite"}}) {
      Words words{"run", file, "--out", name};
      words.insert(words.end(), more.begin(), more.end());
      expect_refusal(words, {"symbolic link", "never followed"});
    }
  }
  make_folder("results");
  for (const std::string name : {"report.html", "results.json", "figure-1.svg", "log"}) {
    const fs::path link = folder() / "results" / name;
    fs::create_symlink(name == "log" ? "../elsewhere/log" : "../elsewhere/precious", link);
    expect_refusal({"run", file, "--out", "results"}, {"results/" + name, "symbolic link"});
    expect_refusal({"run", file, "--out", "results", "--overwrite"}, {"results/" + name, "symbolic link"});
    fs::remove(link);
  }
  EXPECT_EQ(content("elsewhere/precious"), "kept");
  EXPECT_TRUE(fs::is_empty(folder() / "elsewhere/log"));
  // Above the folder a link is a part of the path like any other.
  EXPECT_EQ(tactus({"run", file, "--out", "link/new"}).status, 0);
}

TEST_F(Overwrite, AFolderThatIsNotForResultsIsRefused) {
  const std::string file = quick_experiment();
  make_folder("home");
  setenv("HOME", (folder() / "home").c_str(), 1);
  make_folder("shared");
  write("shared/letter.txt", "mine");
  write("shared/.hidden", "mine");
  for (const Words& more : {Words{}, Words{"--overwrite"}}) {
    const auto refused = [&](const char* place, const std::string& why) {
      Words words{"run", file, "--out", place};
      words.insert(words.end(), more.begin(), more.end());
      expect_refusal(words, {why, "name a folder of its own"});
    };
    refused("/", "is the root of the file system");
    refused("/.", "is the root of the file system");
    refused("/etc", "holds other files");
    refused("home", "is your home folder");
    refused("shared", "holds other files, as '.hidden'");
    refused(".", "holds other files");
  }
  // Neither an empty folder, nor one of an earlier run to which a person has added something.
  make_folder("empty");
  EXPECT_EQ(tactus({"run", file, "--out", "empty"}).status, 0);
  write("empty/notes.txt", "mine");
  EXPECT_EQ(tactus({"run", file, "--out", "empty", "--overwrite"}).status, 0);
  EXPECT_EQ(content("empty/notes.txt"), "mine");
  // What a killed map leaves is gone on with.
  make_folder("killed");
  write("killed/tasks.partial", "");
  EXPECT_EQ(tactus({"run", file, "--out", "killed"}).status, 0);
}

TEST_F(Overwrite, AnExportIsKeptLikewise) {
  ASSERT_EQ(tactus({"run", quick_experiment(), "--out", "run"}).status, 0);
  write("tap.csv", "mine");
  fs::create_symlink("tap.csv", folder() / "link.csv");
  expect_refusal({"export", "run/log", "--to", "csv", "--out", "tap.csv"}, {"--out", "'tap.csv'", "--overwrite"});
  for (const Words& more : {Words{}, Words{"--overwrite"}}) {
    Words words{"export", "run/log", "--to", "csv", "--out", "link.csv"};
    words.insert(words.end(), more.begin(), more.end());
    expect_refusal(words, {"link.csv", "symbolic link"});
  }
  EXPECT_EQ(content("tap.csv"), "mine");
  EXPECT_EQ(tactus({"export", "run/log", "--to", "csv", "--out", "tap.csv", "--overwrite"}).status, 0);
  EXPECT_TRUE(content("tap.csv").starts_with("time [s],"));
  ASSERT_EQ(tactus({"export", "run/log", "--to", "csv"}).status, 0);
  expect_refusal({"export", "run/log", "--to", "csv"}, {"run/log/log.csv", "--overwrite"});
}

TEST_F(Overwrite, EveryVerbWithAPlaceForResultsCanBeToldTo) {
  std::size_t verbs = 0;
  for (const Words& verb :
       {Words{"run"}, Words{"advise"}, Words{"serve"}, Words{"doctor"}, Words{"faults"}, Words{"export"},
        Words{"estimate", "force"}, Words{"identify", "inverse"}, Words{"identify", "frf"},
        Words{"identify", "isolate"}, Words{"identify", "quick"}, Words{"identify", "operator"},
        Words{"identify", "prediction"}, Words{"stability", "map"}, Words{"stability", "margins"},
        Words{"stability", "limit"}, Words{"stability", "scorecard"}, Words{"stability", "two-port"}}) {
    Words words = verb;
    words.emplace_back("--help");
    const std::string help = tactus(words).out;
    EXPECT_NE(help.find("--out "), std::string::npos) << verb.back();
    EXPECT_NE(help.find("--overwrite"), std::string::npos) << verb.back();
    ++verbs;
  }
  EXPECT_EQ(verbs, 18U);
}

TEST_F(Overwrite, ALogCanBeLimited) {
  const std::string file = quick_experiment();
  const Outcome outcome =
      tactus({"run", file, "--vary", "control.force_gain=1,3", "--out", "results", "--log-limit", "20MB"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(left("results/log/log_0.mcap"));
  EXPECT_FALSE(left("results/log/log.mcap"));
  EXPECT_EQ(tactus({"export", "results/log", "--to", "mat"}).status, 0);
  expect_refusal({"run", file, "--out", "small", "--log-limit", "5MB"}, {"--log-limit", "8 MiB or more"});
  expect_refusal({"run", file, "--out", "small", "--log-limit", "lots"}, {"--log-limit"});
  expect_refusal({"run", file, "--log-limit", "20MB"}, {"--out"});
}

}  // namespace
}  // namespace tactus::cli
