// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/cli/command.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace serve_test {

using Serve = Command;

TEST_F(Serve, LeavesAReportAndALog) {
  const Outcome outcome = tactus({"serve", "--port", "0", "--duration-s", "0.3", "--out", "session"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("connections taken"), std::string::npos) << outcome.out;
  const auto document = nlohmann::json::parse(content("session/results.json"));
  EXPECT_GT(document["duration_s"], 0.1);
  EXPECT_TRUE(document["contacts"].empty());
  EXPECT_NE(content("session/report.html").find("Nobody touched the wall"), std::string::npos);
  EXPECT_NE(content("session/log/log.mcap").find("[control.model"), std::string::npos) << "its configuration";
  EXPECT_FALSE(content("session/log/metadata.yaml").empty());
}

TEST_F(Serve, SaysAtOnceThatAReportCannotBeWritten) {
  const Outcome outcome =
      tactus({"serve", "--port", "0", "--duration-s", "0.3", "--out", write("file", "") + "/below"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("file"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out, "");
}

}  // namespace serve_test
}  // namespace tactus::cli
