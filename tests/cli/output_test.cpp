// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "tests/cli/command.hpp"

namespace tactus::cli {
namespace {

using Output = Command;
using Words = std::vector<std::string>;

constexpr StandardOutput broken[] = {StandardOutput::full, StandardOutput::closed};

TEST_F(Output, ResultsThatCannotBePrintedAreAFailureOfTheJob) {
  const std::string file = quick_experiment();
  for (const StandardOutput output : broken) {
    for (const Words& arguments : {Words{"run", file}, Words{"run", file, "--json"}}) {
      const Outcome outcome = tactus(arguments, output);
      EXPECT_EQ(outcome.status, 1);
      EXPECT_EQ(outcome.err, "tactus: standard output: the output could not be written: give it a place with room\n");
    }
  }
}

TEST_F(Output, NorDoSchemaReferenceHelpAndVersionFailInSilence) {
  for (const StandardOutput output : broken) {
    for (const Words& arguments : {Words{"schema"}, Words{"schema", "--reference"}, Words{"--help"},
                                   Words{"run", "--help"}, Words{"--version"}}) {
      const Outcome outcome = tactus(arguments, output);
      EXPECT_EQ(outcome.status, 1) << arguments.front();
      EXPECT_TRUE(outcome.err.starts_with("tactus: standard output: ")) << outcome.err;
    }
  }
}

TEST_F(Output, AWrongRequestIsWrongWhereverTheOutputGoes) {
  for (const StandardOutput output : broken) {
    EXPECT_EQ(tactus({"run", "missing.toml"}, output).status, 2);
    EXPECT_EQ(tactus({}, output).status, 2);
  }
}

}  // namespace
}  // namespace tactus::cli
