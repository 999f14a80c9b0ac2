// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using GoodUse = Command;
using Words = std::vector<std::string>;
using Json = nlohmann::json;

const std::string experiment_folder = TACTUS_EXPERIMENT_FOLDER;

TEST_F(GoodUse, HelpAndVersionAreNoErrors) {
  for (const Words& arguments : {Words{"--help"}, Words{"-h"}, Words{"run", "--help"}, Words{"schema", "--help"}}) {
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_NE(outcome.out.find("Usage: tactus"), std::string::npos) << outcome.out;
  }
  const Outcome version = tactus({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_TRUE(std::regex_search(version.out, std::regex("^tactus [0-9]+\\.[0-9]+\\.[0-9]+\n"))) << version.out;
}

TEST_F(GoodUse, ATableIsPrintedAndNothingElseHappens) {
  const std::string file = quick_experiment();
  const Outcome outcome = tactus({"run", file, "--vary", "control.force_gain=1,15"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.out.find("settling,"), std::string::npos);
  EXPECT_NE(outcome.out.find("verdict"), std::string::npos);
  // No terminal, so no line of progress, and no colours or other control characters.
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(outcome.out.find('\033'), std::string::npos);
  EXPECT_EQ(outcome.out.find('\r'), std::string::npos);
  EXPECT_EQ(files(), Words{file});
}

TEST_F(GoodUse, JsonIsOneDocumentAndNothingElse) {
  const Outcome outcome = tactus({"run", quick_experiment(), "--json", "--vary", "control.force_gain=1,3", "--vary",
                                  "control.cancellation=off,on", "--out", "results"});
  EXPECT_EQ(outcome.status, 0);
  const Json json = Json::parse(outcome.out, nullptr, false);
  ASSERT_FALSE(json.is_discarded()) << outcome.out;
  EXPECT_EQ(json["experiment"], "quick");
  ASSERT_EQ(json["runs"].size(), 4U);
  EXPECT_EQ(json["runs"][3]["set"], Json({{"control.force_gain", 3}, {"control.cancellation", "on"}}));
  EXPECT_EQ(content("results/results.json"), outcome.out);
  EXPECT_EQ(outcome.err, "Report: results/report.html\nLog: results/log\n");
}

TEST_F(GoodUse, SetOverridesTheFileAndTheLastSetWins) {
  const Words command{"run", quick_experiment(), "--json", "--set", "task.taps=5", "--set", "task.taps=2"};
  const Outcome outcome = tactus(command);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out)["runs"][0]["metrics"]["taps"], 2);
}

TEST_F(GoodUse, OutLeavesReportResultsAndEveryFigureInANewFolder) {
  const std::string file = quick_experiment();
  const Outcome outcome =
      tactus({"run", file, "--vary", "control.force_gain=1,3", "--out", "new/results", "--set", "task.taps=2"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(outcome.out.ends_with("Report: new/results/report.html\nLog: new/results/log\n")) << outcome.out;
  Words expected{"new", "new/results"};
  Words left = files();
  EXPECT_EQ(std::count_if(left.begin(), left.end(), [](const std::string& name) { return name.ends_with(".toml"); }),
            1);
  std::erase(left, file);
  std::size_t figures = 0;
  for (const std::string& name : left) {
    if (!name.ends_with(".svg")) continue;
    ++figures;
    EXPECT_TRUE(content(name).starts_with("<svg") || content(name).starts_with("<?xml")) << name;
    expected.push_back("new/results/figure-" + std::to_string(figures) + ".svg");
  }
  EXPECT_GE(figures, 1U);
  expected.insert(expected.end(), {"new/results/log", "new/results/log/log.mcap", "new/results/log/metadata.yaml",
                                   "new/results/report.html", "new/results/results.json"});
  EXPECT_EQ(left, expected);

  const std::string report = content("new/results/report.html");
  EXPECT_NE(report.find("<svg"), std::string::npos);
  EXPECT_NE(report.find("tactus run quick.toml --vary control.force_gain=1,3 --out new/results"), std::string::npos);
  EXPECT_NE(report.find("force_gain = 1.0"), std::string::npos) << "the whole configuration belongs to the report";
}

TEST_F(GoodUse, TheReportNeedsNothingButItself) {
  ASSERT_EQ(tactus({"run", quick_experiment(), "--out", "results"}).status, 0);
  const std::string report = content("results/report.html");
  // Whatever a browser would fetch: links, sources, style imports, url(...) other than within the page.
  EXPECT_FALSE(std::regex_search(report, std::regex("(src|href|srcset|data|action)\\s*=\\s*[\"'](?!#)")));
  EXPECT_FALSE(std::regex_search(report, std::regex("url\\(\\s*[\"']?(?!#)")));
  EXPECT_EQ(report.find("@import"), std::string::npos);
  std::string without_namespaces = report;
  for (const std::string name : {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xhtml"}) {
    for (std::size_t at; (at = without_namespaces.find(name)) != std::string::npos;)
      without_namespaces.erase(at, name.size());
  }
  EXPECT_EQ(without_namespaces.find("://"), std::string::npos);
}

TEST_F(GoodUse, TheSameCommandTwiceLeavesTheSameBytes) {
  const Words command{"run",   quick_experiment(), "--vary",     "control.cancellation=off,on", "--set", "task.taps=3",
                      "--out", "results",          "--overwrite"};
  const Outcome first = tactus(command);
  ASSERT_EQ(first.status, 0) << first.err;
  const Words names = files();
  std::vector<std::string> contents;
  for (const std::string& name : names) contents.push_back(content(name));
  const Outcome second = tactus(command);
  EXPECT_EQ(second.out, first.out);
  EXPECT_EQ(files(), names);
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(content(names[i]), contents[i]) << names[i];
}

TEST_F(GoodUse, TheExperimentsOfTheRepositoryRun) {
  for (const std::string name : {"tapping", "force-display"}) {
    Words command{"run", experiment_folder + "/" + name + ".toml", "--json"};
    if (name == "tapping") command.insert(command.end(), {"--set", "task.taps=2"});
    const Outcome outcome = tactus(command);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(Json::parse(outcome.out)["experiment"], name);
  }
}

/// What a schema says of a key, or nothing: `control.force_gain` stands below properties of properties.
Json described(const Json& schema, const std::string& path) {
  Json here = schema;
  std::istringstream keys(path);
  for (std::string key; std::getline(keys, key, '.');) {
    if (!here.contains("properties") || !here["properties"].contains(key)) return {};
    here = here["properties"][key];
  }
  return here;
}

/// The keys that a TOML file of this repository writes, in the few forms that it uses.
Words keys_written_in(const std::string& file) {
  std::ifstream stream(file);
  Words keys;
  std::string section;
  const std::regex table("\\[([\\w.]+)\\].*"), inline_table("(\\w+) = \\{(.*)\\}.*"), value("(\\w+) = .*");
  for (std::string line; std::getline(stream, line);) {
    std::smatch match;
    if (std::regex_match(line, match, table)) {
      section = match[1];
    } else if (std::regex_match(line, match, inline_table)) {
      const std::string inside = match[2], outer = match[1];
      const std::regex inner("(\\w+) =");
      for (std::sregex_iterator i(inside.begin(), inside.end(), inner), end; i != end; ++i) {
        keys.push_back(section + "." + outer + "." + (*i)[1].str());
      }
    } else if (std::regex_match(line, match, value)) {
      keys.push_back(section + "." + match[1].str());
    }
  }
  return keys;
}

TEST_F(GoodUse, TheSchemaKnowsEveryKeyOfTheExperimentsOfTheRepository) {
  for (const std::string kind : {"tapping", "force-display"}) {
    const Outcome outcome = tactus({"schema", kind});
    ASSERT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err, "");
    const Json schema = Json::parse(outcome.out, nullptr, false);
    ASSERT_FALSE(schema.is_discarded());
    EXPECT_EQ(schema["type"], "object");
    const Words keys = keys_written_in(experiment_folder + "/" + kind + ".toml");
    EXPECT_GE(keys.size(), 7U);
    for (const std::string& key : keys) EXPECT_FALSE(described(schema, key).is_null()) << kind << ": " << key;
    EXPECT_TRUE(described(schema, "control.no_such_key").is_null());
  }
  const Json tapping = Json::parse(tactus({"schema"}).out);
  const Json gain = described(tapping, "control.force_gain");
  EXPECT_EQ(gain["type"], "number");
  EXPECT_EQ(gain["minimum"], 0);
  EXPECT_EQ(gain["maximum"], 1000);
  EXPECT_EQ(described(tapping, "control.cancellation")["enum"], Json({"off", "on"}));
}

TEST_F(GoodUse, TheReferenceIsMarkdownWithEveryKeyOnce) {
  const Outcome outcome = tactus({"schema", "force-display", "--reference"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(outcome.out.starts_with("# ")) << outcome.out.substr(0, 80);
  for (const std::string key : {"speed_m_per_s", "repeats", "decay_time_s"}) {
    const auto at = outcome.out.find("`" + key + "`");
    EXPECT_NE(at, std::string::npos) << key;
    EXPECT_EQ(outcome.out.find("`" + key + "`", at + 1), std::string::npos) << key;
  }
}

}  // namespace
}  // namespace tactus::cli
