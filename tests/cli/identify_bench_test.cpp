// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include "tests/cli/schema_validator.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using Bench = Command;
using Json = nlohmann::json;

TEST_F(Bench, TheFilesThatItWritesAreAnExperimentsMasterAndModel) {
  const Outcome found =
      tactus({"identify", "isolate", "--rig", "simulated", "--seed", "1004", "--json", "--out", "results"});
  ASSERT_EQ(found.status, 0) << found.err;
  const Json document = Json::parse(found.out);
  EXPECT_EQ(SchemaValidator(Json::parse(tactus({"schema", "--results", "identify", "isolate"}).out)).faults(document),
            "");
  EXPECT_EQ(document["rig"], "simulated rig 1004");
  EXPECT_GE(document["parameters"].size(), 18U);
  for (const Json& parameter : document["parameters"]) {
    EXPECT_TRUE(parameter["determined"].is_boolean());
    EXPECT_LT(parameter["interval_95"][0], parameter["interval_95"][1]) << parameter;
  }
  EXPECT_EQ(document["parameters"][4]["name"], "motor.mass_kg");
  EXPECT_EQ(document["parameters"][4]["unit"], "kg");
  EXPECT_TRUE(document["parameters"][4].contains("truth"));
  EXPECT_NE(found.err.find("lock the drum"), std::string::npos) << found.err;
  EXPECT_NE(content("results/report.html").find("drum locked"), std::string::npos);

  const Outcome run =
      tactus({"run", quick_experiment(), "--with", "results/rig.toml", "--with", "results/model.toml", "--json"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(Json::parse(run.out)["runs"], Json::parse(tactus({"run", "quick.toml", "--json"}).out)["runs"]);
}

TEST_F(Bench, AnUnknownRigIsRefusedBeforeAnyFileIsMade) {
  for (const char* verb : {"isolate", "quick"}) {
    const Outcome refused = tactus({"identify", verb, "--rig", "phantom", "--out", "results"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_EQ(refused.out, "");
    EXPECT_NE(refused.err.find("'phantom'"), std::string::npos) << refused.err;
  }
  EXPECT_EQ(tactus({"identify", "isolate"}).status, 2);
  EXPECT_EQ(tactus({"identify", "isolate", "--rig", "simulated", "--seed", "-1"}).status, 2);
  EXPECT_TRUE(files().empty());
}

TEST_F(Bench, AForeignSessionIsRefused) {
  make_folder("session");
  write("session/run-001.csv", "time_s,force_N\n0,1\n1,2\n");
  const Outcome refused = tactus({"identify", "isolate", "--rig", "simulated", "--session", "session"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("run-001.csv"), std::string::npos) << refused.err;
}

TEST_F(Bench, AModelFilesMistakeIsNamedWithItsFileLineAndKey) {
  write("model.toml", "[control.model]\n[control.model.motor]\nmass_g = 7.5\n");
  const Outcome refused = tactus({"run", quick_experiment(), "--with", "model.toml"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("model.toml:3:1"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("mass_kg"), std::string::npos) << refused.err;
  EXPECT_EQ(tactus({"run", quick_experiment(), "--with", "none.toml"}).status, 2);
}

}  // namespace
}  // namespace tactus::cli
