// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using Doctor = Command;
using Words = std::vector<std::string>;
using Json = nlohmann::json;

const Words quick_look{"doctor", "--duration-s", "0.2", "--priority", "10"};

Words with(const Words& more) {
  Words all = quick_look;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST_F(Doctor, EveryFindingHasItsVerdictMeaningAndRemedyAndTheExitStatusSaysWhetherAnyIsBad) {
  const Outcome outcome = tactus(with({"--json"}));
  const Json document = Json::parse(outcome.out);
  bool bad = false;
  EXPECT_EQ(document["findings"].size(), 12U);
  for (const Json& finding : document["findings"]) {
    const std::string verdict = finding["verdict"];
    EXPECT_FALSE(finding["found"].get<std::string>().empty());
    EXPECT_FALSE(finding["means"].get<std::string>().empty());
    if (verdict == "bad" || verdict == "poor") {
      EXPECT_FALSE(finding["remedy"].get<std::string>().empty()) << finding.dump();
    }
    bad = bad || verdict == "bad";
  }
  EXPECT_EQ(document["can_keep_time"], !bad);
  EXPECT_EQ(outcome.status, bad ? 1 : 0);
  EXPECT_EQ(outcome.err, "");
  const Json& servo = document["servo"];
  EXPECT_GE(servo["ticks"].get<int>() + servo["missed"].get<int>(), 1000);
  EXPECT_LE(servo["lateness"]["p50_us"], servo["lateness"]["p999_us"]);
}

TEST_F(Doctor, APersonGetsATableAndWhatItMeans) {
  const Outcome outcome = tactus(quick_look);
  EXPECT_NE(outcome.out.find("scheduler"), std::string::npos);
  EXPECT_NE(outcome.out.find("lateness: a control cycle starts this long after it is due"), std::string::npos)
      << outcome.out;
}

TEST_F(Doctor, ItsReportHoldsEveryFindingAndHowTimeWasKept) {
  const Outcome outcome = tactus(with({"--out", "machine"}));
  EXPECT_NE(outcome.out.find("machine/report.html"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_EQ(files(), (Words{"machine", "machine/figure-1.svg", "machine/report.html", "machine/results.json"}));
  const std::string page = content("machine/report.html");
  const Json results = Json::parse(content("machine/results.json"));
  for (const Json& finding : results["findings"]) {
    EXPECT_NE(page.find(finding["name"].get<std::string>()), std::string::npos) << finding["name"];
  }
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("tactus doctor"), std::string::npos) << "how to repeat it";
}

TEST_F(Doctor, AWrongRequestIsRefusedByName) {
  for (const Words& wrong : {Words{"--duration-s", "0"}, Words{"--rate-Hz", "0"}, Words{"--priority", "100"},
                             Words{"--spin-s", "0.0002"}, Words{"--core", "-2"}}) {
    const Outcome outcome = tactus(with(wrong));
    EXPECT_EQ(outcome.status, 2) << wrong.front();
    std::string name = wrong.front().substr(2);
    for (char& c : name) c = c == '-' ? '_' : c;
    EXPECT_TRUE(outcome.err.find(name) != std::string::npos || outcome.err.find(wrong.front()) != std::string::npos)
        << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

}  // namespace
}  // namespace tactus::cli
