// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/json_schema.hpp>
#include <tactus/data/configuration/reference.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <string>

#include <gtest/gtest.h>

namespace tactus::simulation {
namespace own_keys_test {

enum class Bend { sharp, soft };
constexpr auto enumerators(Bend) {
  return std::array{Enumerator{Bend::sharp, "sharp"}, Enumerator{Bend::soft, "soft"}};
}

/// Keys that no architecture of the library has.
struct BendParams {
  double from_N = 0.5;
  Bend kind = Bend::soft;
  control::ServoPd::Params inner{.proportional_N_per_m = 7.0};
  static constexpr auto fields() {
    return List{field("from_N", &BendParams::from_N, units::newton, between(0.0, 2.0), "Where it begins."),
                field("kind", &BendParams::kind, "Its shape."),
                field("inner", &BendParams::inner, "The controller behind it.")};
  }
};

using Params = Teleoperator::Params;

class OwnKeys : public ::testing::Test {
 protected:
  void SetUp() override {
    control::Architecture plugged = *control::find_architecture("position-force");
    plugged.name = "bend";
    plugged.keys = control::own_keys<BendParams>("bend", "Architecture bend: where and how.");
    ASSERT_FALSE(control::register_architecture(plugged));
  }
  static Result<Params> read(const std::string& text, const std::string& assignment = {}) {
    auto document = configuration::Document::parse(text, "bend.toml");
    if (!document) return document.error();
    if (!assignment.empty()) {
      if (auto error = document->set(assignment)) return *std::move(error);
    }
    return document->read<Params>();
  }
};

TEST_F(OwnKeys, AreReadFromAFileAndOverriddenAndWhatIsNotWrittenKeepsItsDefault) {
  const auto params = read("[control]\narchitecture = \"bend\"\n[control.bend]\nfrom_N = 0.25\nkind = \"sharp\"\n",
                           "control.bend.inner.derivative_N_s_per_m=3");
  ASSERT_TRUE(params) << describe(params.error());
  const auto& bend = params->control.own<BendParams>();
  EXPECT_EQ(bend.from_N, 0.25);
  EXPECT_EQ(bend.kind, Bend::sharp);
  EXPECT_EQ(bend.inner.proportional_N_per_m, 7.0);
  EXPECT_EQ(bend.inner.derivative_N_s_per_m, 3.0);
  EXPECT_TRUE(Teleoperator::make(*params, 0.0));
}

TEST_F(OwnKeys, AreWrittenWithTheOthersAndReadBackEqual) {
  const auto params = read("[control.bend]\nfrom_N = 0.1\nkind = \"sharp\"\n");
  ASSERT_TRUE(params);
  const std::string text = configuration::to_toml(*params);
  EXPECT_NE(text.find("\n[control.bend]\nfrom_N = 0.1\nkind = \"sharp\"\n\n[control.bend.inner]\n"), std::string::npos);
  const auto again = read(text);
  ASSERT_TRUE(again) << describe(again.error());
  EXPECT_EQ(configuration::to_toml(*again), text);
}

TEST_F(OwnKeys, AWrongOneIsAnsweredWithItsPlace) {
  const auto refusal = [](const std::string& text, const std::string& assignment = {}) {
    const auto params = read(text, assignment);
    return params ? std::string("was read") : describe(params.error());
  };
  EXPECT_EQ(refusal("[control.bend]\nfrom_N = 2.5\n"),
            "bend.toml:2:10: control.bend.from_N: 2.5 N is out of bounds: it must be at least 0 N and at most 2 N");
  EXPECT_EQ(refusal("[control.bend]\nform_N = 1.0\n"),
            "bend.toml:2:1: control.bend.form_N: unknown key: did you mean from_N?");
  EXPECT_EQ(refusal("[control.bent]\n"), "bend.toml:1:10: control.bent: unknown section: did you mean bend?");
  EXPECT_EQ(refusal("", "control.bend.kind=soff"),
            "--set control.bend.kind=soff: control.bend.kind: \"soff\" is no choice here: it must be \"sharp\" or "
            "\"soft\"; did you mean \"soft\"?");
}

TEST_F(OwnKeys, StandInTheSchemaAndOnTheReferencePageOnce) {
  const std::string page = configuration::reference_markdown<Params>("Teleoperator");
  const std::string heading = "\n## `[control.bend]`\n\nArchitecture bend: where and how.\n";
  EXPECT_NE(page.find(heading), std::string::npos);
  EXPECT_EQ(page.find(heading), page.rfind(heading));
  EXPECT_NE(page.find("| `from_N` | N |"), std::string::npos) << page;
  EXPECT_NE(configuration::json_schema<Params>("Teleoperator").find("\"bend\": {"), std::string::npos);
}

}  // namespace own_keys_test
}  // namespace tactus::simulation
