// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/hardware/devices/rig/rig_agreement.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::devices {
namespace rig_agreement_test {

using control::Agreement;
using control::AgreementCheck;

const std::string rigs = TACTUS_RIG_FOLDER;

experiments::ArmPairSetup setup_of(const std::vector<std::string>& more = {}) {
  auto document = configuration::Document::load(rigs + "/arms.toml");
  EXPECT_TRUE(document) << describe(document.error());
  for (const std::string& one : more) EXPECT_FALSE(document->set(one)) << one;
  const auto params = document->read<experiments::ArmTappingParams>();
  EXPECT_TRUE(params) << describe(params.error());
  const auto setup = experiments::set_up_arm_pair(*params, rigs);
  EXPECT_TRUE(setup) << describe(setup.error());
  return *setup;
}

RigPair pair_of() {
  const auto rig = Rig::load(rigs + "/openarm-arms.toml");
  EXPECT_TRUE(rig) << describe(rig.error());
  return rig->pairs()[0];
}

RigAgreement agreement_of(const RigPair& pair, const std::vector<std::string>& more = {}) {
  const experiments::ArmPairSetup setup = setup_of(more);
  return RigAgreement::of(*pair.leader, setup.params, setup);
}

/// What a site says after it has heard all packets of the other.
std::string said(const RigAgreement& own, const RigAgreement& other) {
  const Agreement told = other.agreement();
  AgreementCheck check(own.agreement());
  for (std::size_t cell = 0; cell < told.size(); ++cell) check.take(7, told.excerpt(static_cast<std::int64_t>(cell)));
  EXPECT_TRUE(check.complete());
  if (!check.disagrees()) return {};
  return own.describe({.agreement = check}, control::SiteRole::master);
}

TEST(RigAgreement, OfTwoArmsNamesEachKeyThatDiffersWithBothValues) {
  const RigPair pair = pair_of();
  const RigAgreement plain = agreement_of(pair);
  EXPECT_EQ(said(plain, plain), "");
  const std::pair<const char*, const char*> sets[]{{"rig.leader_gate.force_limit_N", "3.25"},
                                                   {"rig.follower_gate.force_limit_N", "3.25"},
                                                   {"rig.follower_gate.velocity_limit_m_per_s", "2.5"},
                                                   {"rig.follower_gate.rate_limit_N_per_s", "41.0"},
                                                   {"rig.supervision.packets.longest_age_s", "0.125"},
                                                   {"rig.supervision.watchdog.timeout_s", "0.375"},
                                                   {"rig.supervision.answer_within_s", "0.625"},
                                                   {"rig.supervision.blend_s", "1.625"},
                                                   {"arm.tool.x_m", "0.0625"},
                                                   {"arm.tool.z_m", "0.1875"}};
  for (const auto& [key, value] : sets) {
    const std::string set = std::string(key) + "=" + value;
    const RigAgreement other = agreement_of(pair, {set});
    const std::string here = said(plain, other), there = said(other, plain);
    EXPECT_NE(here.find(std::string(key) + " is "), std::string::npos) << here;
    EXPECT_NE(there.find(std::string(key) + " is "), std::string::npos) << there;
    const std::string number = format_number(std::stod(value));
    EXPECT_NE(here.find(" and " + number), std::string::npos) << here;
    EXPECT_NE(there.find(" is " + number), std::string::npos) << there;
    EXPECT_EQ(here.find("none of which"), std::string::npos) << here;
  }
}

TEST(RigAgreement, OfTwoArmsHasACellForEveryValue) {
  const RigPair pair = pair_of();
  EXPECT_LT(agreement_of(pair).agreement().size(), Agreement::most_cells);
}

}  // namespace rig_agreement_test
}  // namespace tactus::devices
