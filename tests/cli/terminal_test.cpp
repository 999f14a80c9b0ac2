// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::cli {
namespace {

using Words = std::vector<std::string>;

class Terminal : public Command {
 protected:
  /// What a terminal of so many columns shows.
  [[nodiscard]] std::string shown(Words words, unsigned short columns, const char* no_color = nullptr) const {
    words.insert(words.begin(), TACTUS_COMMAND);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const winsize size{.ws_row = 50, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
    if (child == 0) {
      setenv("TERM", "xterm", 1);
      unsetenv("NO_COLOR");
      if (no_color != nullptr) setenv("NO_COLOR", no_color, 1);
      if (chdir(folder().c_str()) != 0) _exit(126);
      execv(argv[0], argv.data());
      _exit(127);
    }
    EXPECT_GT(child, 0);
    std::string text;
    std::array<char, 4096> piece{};
    for (ssize_t got = 0; (got = ::read(terminal, piece.data(), piece.size())) > 0;) {
      text.append(piece.data(), static_cast<std::size_t>(got));
    }
    close(terminal);
    waitpid(child, nullptr, 0);
    return text;
  }

  void expect_refusal(const Words& arguments, const Words& told, const Words& not_told = {}) const {
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    for (const std::string& words : told) EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    for (const std::string& words : not_told) EXPECT_EQ(outcome.err.find(words), std::string::npos) << outcome.err;
  }

  /// Every verb and every verb below one, from what help lists.
  void for_each_command(const Words& verb, const auto& use) const {
    use(verb);
    Words help = verb;
    help.push_back("--help");
    std::istringstream lines(tactus(help).out);
    bool verbs = false;
    for (std::string line; std::getline(lines, line);) {
      if (line == "Subcommands:" || line == "Run:") verbs = true;
      if (line == "Example:") break;
      if (!verbs || !line.starts_with("  ") || line[2] == ' ') continue;
      Words next = verb;
      next.push_back(line.substr(2, line.find(' ', 2) - 2));
      for_each_command(next, use);
    }
  }
};

/// Columns of a line of UTF-8 without wide characters.
std::size_t columns_of(const std::string& line) {
  std::size_t columns = 0;
  for (const char c : line) columns += (static_cast<unsigned char>(c) & 0xc0U) != 0x80U ? 1U : 0U;
  return columns;
}

TEST_F(Terminal, NoLineOfAnyHelpIsWiderThanEightyColumns) {
  std::size_t verbs = 0;
  for_each_command({}, [&](Words verb) {
    ++verbs;
    verb.push_back("--help");
    std::istringstream lines(tactus(verb).out);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(columns_of(line), 80U) << line;
  });
  EXPECT_GT(verbs, 35U);
}

TEST_F(Terminal, EveryCommandHasAnExampleWhoseOptionsItHas) {
  for_each_command({}, [&](Words command) {
    if (command.empty()) return;
    SCOPED_TRACE(::testing::PrintToString(command));
    command.push_back("--help");
    const std::string help = tactus(command).out;
    const std::size_t at = help.find("\nExample:\n  tactus " + command.front());
    ASSERT_NE(at, std::string::npos) << help;
    if (help.find("\nSubcommands:\n") != std::string::npos) return;  // the example is one of a subcommand
    std::istringstream words(help.substr(at));
    for (std::string word; words >> word;) {
      if (word.starts_with("--")) {
        EXPECT_LT(help.find("  " + word), at) << word;
      }
    }
  });
}

TEST_F(Terminal, CommandsAreGroupedAndOptionsInOneOrder) {
  const std::string all = tactus({"--help"}).out;
  std::size_t from = 0;
  for (const char* group : {"\nRun:\n", "\nUnderstand:\n", "\nIdentify:\n", "\nDevices:\n", "\nData:\n", "\nHelp:\n"}) {
    const std::size_t at = all.find(group);
    ASSERT_NE(at, std::string::npos) << group;
    EXPECT_GT(at, from) << group;
    from = at;
  }
  EXPECT_EQ(all.find("\nSubcommands:"), std::string::npos);
  for_each_command({}, [&](Words command) {
    command.push_back("--help");
    const std::string help = tactus(command).out;
    std::size_t last = 0;
    for (const char* option :
         {"\n  --with ", "\n  --set ", "\n  --vary ", "\n  --seed ", "\n  --out ", "\n  --overwrite", "\n  --json"}) {
      const std::size_t at = help.find(option);
      if (at == std::string::npos) continue;
      EXPECT_GT(at, last) << help;
      last = at;
    }
  });
}

TEST_F(Terminal, HelpOfAVerbIsTheSameEitherWay) {
  EXPECT_EQ(tactus({"help"}).out, tactus({"--help"}).out);
  EXPECT_EQ(tactus({"help", "run"}).out, tactus({"run", "--help"}).out);
  EXPECT_EQ(tactus({"help", "identify", "frf"}).out, tactus({"identify", "frf", "--help"}).out);
  expect_refusal({"help", "rnu"}, {"'rnu' is no command: did you mean run?"});
}

TEST_F(Terminal, TheVersionSaysHowItWasBuilt) {
  const std::string text = tactus({"--version"}).out;
  EXPECT_TRUE(text.starts_with("tactus ")) << text;
  for (const char* fact : {"\ncompiler: ", "\nbuild: ", "\nassertions: o", "\nsanitizers: "}) {
    EXPECT_NE(text.find(fact), std::string::npos) << text;
  }
}

TEST_F(Terminal, AVerbOrAWordThatIsNearlyRightIsSuggestedAndTheOppositeNever) {
  const std::string quick = quick_experiment();
  expect_refusal({"rnu", quick}, {"'rnu' is no command: did you mean run?"});
  expect_refusal({"stability", "margin", quick}, {"'margin' is no command: did you mean margins?"});
  expect_refusal({"run", quick, "--overwite"}, {"'--overwite' is no option of run: did you mean --overwrite?"});
  expect_refusal({"xyzzy"}, {"'xyzzy' is no command"}, {"did you mean"});
  expect_refusal({"run", quick, "--set", "control.cancellation=no"}, {"control.cancellation", "off"}, {"did you mean"});
  expect_refusal({"run", quick, "--set", "control.cancellation=of"}, {"did you mean \"off\"?"});
}

TEST_F(Terminal, AKeyIsVariedOrSetAndNotBoth) {
  const std::string quick = quick_experiment();
  expect_refusal({"run", quick, "--set", "control.force_gain=3", "--vary", "control.force_gain=1,2"},
                 {"--vary: control.force_gain", "leave out --set control.force_gain=3"});
  EXPECT_EQ(tactus({"run", quick, "--set", "control.force_limit_N=3", "--vary", "control.force_gain=1,2"}).status, 0);
}

TEST_F(Terminal, RunSaysWhatRunsAMap) {
  write("map.toml", "[task]\nkind = \"stability-map\"\n");
  expect_refusal({"run", "map.toml"}, {"map.toml:2:", "tactus stability map map.toml --vary"});
}

TEST_F(Terminal, AVerdictComesFirst) {
  const std::string quick = quick_experiment();
  EXPECT_TRUE(tactus({"run", quick}).out.starts_with("Settled: 1 of 1 tap settled, half of them within "));
  EXPECT_TRUE(tactus({"run", quick, "--vary", "control.cancellation=on,off", "--set", "control.force_gain=10", "--set",
                      "control.force_limit_N=10"})
                  .out.starts_with("1 of 2 combinations settle; these do not: cancellation off (limit-cycle).\n"));
  EXPECT_TRUE(tactus({"stability", "margins", quick}).out.starts_with("Stable at a force gain of 2.00; the limit is "));
}

TEST_F(Terminal, TablesAreAsWideAsTheTerminalAndLoseNothing) {
  const Words run{"run",    quick_experiment(),
                  "--vary", "control.force_gain=2",
                  "--vary", "environment.stiffness_N_per_m=5000",
                  "--vary", "control.force_limit_N=1"};
  const auto widest = [](const std::string& text) {
    std::size_t most = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) most = std::max(most, columns_of(line));
    return most;
  };
  const std::string narrow = tactus(run).out, wide = shown(run, 200, "1");
  EXPECT_LE(widest(narrow), 80U) << narrow;
  EXPECT_GT(widest(wide), 90U) << wide;
  for (const char* word : {"stiffness", "N/m", "settling", "p90", "contacts", "residual", "verdict"}) {
    EXPECT_NE(narrow.find(word), std::string::npos) << word << "\n" << narrow;
  }
}

TEST_F(Terminal, ColourIsForTerminalsThatWantIt) {
  const Words run{"run", quick_experiment()};
  const std::string green = "\x1b[32msettled\x1b[0m";
  EXPECT_NE(shown(run, 100).find(green), std::string::npos);
  EXPECT_EQ(shown(run, 100, "1").find("\x1b[3"), std::string::npos);
  EXPECT_EQ(tactus(run).out.find('\x1b'), std::string::npos);
  EXPECT_NE(shown({"run", "absent.toml"}, 100).find("\x1b[1;31mtactus:"), std::string::npos);
}

TEST_F(Terminal, AReaderThatWentAwayIsNoErrorAndFilesAreLeft) {
  const Outcome outcome = tactus({"run", quick_experiment(), "--out", "results"}, StandardOutput::reader_gone);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err.find("standard output"), std::string::npos) << outcome.err;
  EXPECT_TRUE(content("results/results.json").starts_with("{"));
}

TEST_F(Terminal, BashCompletesVerbsOptionsAndWords) {
  const Outcome script = tactus({"completion", "bash"});
  ASSERT_EQ(script.status, 0) << script.err;
  write("tactus.bash", script.out);
  const auto completed = [this](const std::string& words, int at) {
    write("ask.sh", ". ./tactus.bash\nCOMP_WORDS=(" + words + ")\nCOMP_CWORD=" + std::to_string(at) +
                        "\n_tactus\nprintf '%s\\n' \"${COMPREPLY[@]}\" >reply\n");
    const std::string command = "cd '" + folder().string() + "' && bash ask.sh";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return content("reply");
  };
  EXPECT_EQ(completed("tactus stab", 1), "stability\n");
  EXPECT_EQ(completed("tactus stability sc", 2), "scorecard\n");
  EXPECT_EQ(completed("tactus identify frf --met", 3), "--method\n");
  EXPECT_EQ(completed("tactus identify frf --method h", 4), "h1\nh2\n");
  EXPECT_EQ(completed("tactus run --out re", 3), "\n") << "a name of a file";
}

}  // namespace
}  // namespace tactus::cli
