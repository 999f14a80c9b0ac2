// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tests/cli/command.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using Words = std::vector<std::string>;

/// Clears a screen, sets a title, does the same by an 8-bit control character as UTF-8 and raw, rings, deletes.
const std::string evil = "\033[2J\033[31mowned\007\302\2332J\2332J\177\bx";

/// The first byte of a text that a terminal would obey, or nothing.
std::string obeyed(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool control = (byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f;
    const bool c1 = byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
    const bool alone = byte >= 0x80 && byte < 0xc0 && (i == 0 || static_cast<unsigned char>(text[i - 1]) < 0x80);
    if (control || c1 || alone) return std::string(text.substr(i, 20));
  }
  return {};
}

class HostileNames : public Command {
 protected:
  void expect_printable(const Words& arguments, int status) const {
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, status) << arguments.front() << ": " << outcome.err;
    EXPECT_EQ(obeyed(outcome.out), "") << arguments.front();
    EXPECT_EQ(obeyed(outcome.err), "") << arguments.front();
    EXPECT_FALSE(outcome.out.empty() && outcome.err.empty());
  }

  /// A recording of a mass that is pushed to and fro, its columns and itself badly named.
  [[nodiscard]] std::string recording() const {
    std::string table = "time," + evil + "position_m," + evil + "force_N\n";
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.001 * i;
      const double w = 6.0 + t;
      table += std::to_string(t) + "," + std::to_string(0.01 * std::sin(w * t)) + "," +
               std::to_string(-0.01 * w * w * std::sin(w * t) + 0.2 * w * std::cos(w * t)) + "\n";
    }
    return write(evil + ".csv", table);
  }
};

TEST_F(HostileNames, InArgumentsReachNoTerminal) {
  expect_printable({evil}, 2);
  expect_printable({"run", evil}, 2);
  expect_printable({"run", quick_experiment(), "--" + evil}, 2);
  expect_printable({"run", "quick.toml", "--set", evil}, 2);
  expect_printable({"run", "quick.toml", "--set", evil + "=1"}, 2);
  expect_printable({"run", "quick.toml", "--set", "control.cancellation=" + evil}, 2);
  expect_printable({"run", "quick.toml", "--vary", evil + "=1,2"}, 2);
  expect_printable({"run", "quick.toml", "--vary", "control.cancellation=off," + evil}, 2);
  expect_printable({"run", "quick.toml", "--realtime", "--plant", evil}, 2);
  expect_printable({"run", "quick.toml", "--site", "master", "--peer", evil, "--unencrypted"}, 2);
  for (const std::string verb : {"export", "replay", "estimate", "identify", "stability", "schema", "key", "relay",
                                 "plant", "serve", "faults", "doctor"}) {
    expect_printable({verb, evil, evil}, 2);
  }
}

TEST_F(HostileNames, OfFilesAndFoldersReachNoTerminalAndLeaveTheJsonWhole) {
  std::filesystem::rename(folder() / quick_experiment(), folder() / (evil + ".toml"));
  expect_printable({"run", evil + ".toml"}, 0);
  expect_printable({"run", evil + ".toml", "--out", evil}, 0);
  const Outcome outcome = tactus({"run", evil + ".toml", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(nlohmann::json::accept(outcome.out)) << outcome.out.substr(0, 200);
  expect_printable({"export", evil + "/log", "--to", "csv"}, 0);
  expect_printable({"export", evil + "/log", "--to", "csv", "--topic", evil}, 2);
  EXPECT_EQ(content(evil + "/report.html").find('\033'), std::string::npos);
}

TEST_F(HostileNames, OfColumnsReachNoTerminalAndNoModelFile) {
  const std::string file = recording();
  for (const Words& more : {Words{}, Words{"--json"}, Words{"--out", "results"}}) {
    Words words{"identify", "inverse", file};
    words.insert(words.end(), more.begin(), more.end());
    expect_printable(words, 0);
  }
  for (const std::string name : {"model.toml", "report.html"}) {
    EXPECT_EQ(obeyed(content("results/" + name)), "") << name;
  }
  EXPECT_TRUE(nlohmann::json::accept(content("results/results.json")));
  expect_printable({"identify", "inverse", file, "--position", evil}, 2);
  expect_printable({"identify", "frf", file, "--input", evil + "force", "--output", evil + "position", "--json"}, 0);
  expect_printable({"estimate", "force", file, "--model", "results/model.toml", "--json"}, 0);
}

TEST_F(HostileNames, OfKeysInAFileReachNoTerminal) {
  expect_printable({"run", write("keys.toml", "[task]\nkind = \"tapping\"\n\"\\u009b2J\\u007f\" = 1\n")}, 2);
  expect_printable({"run", write("value.toml", "[task]\nkind = \"\\u009b2J\\u007f\"\n")}, 2);
  expect_printable({"run", write("syntax.toml", "[task]\nkind = " + evil + "\n")}, 2);
}

}  // namespace
}  // namespace tactus::cli
