// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/control/architectures/time_domain_passivity.hpp>
#include <tactus/kernel/control/supervised_site.hpp>

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::control {
namespace agreement_test {

constexpr Seconds tick{1e-3};

/// Two sites that hear each other; a person at the master arms them and presses the dead-man switch.
struct TwoSites {
  TwoSites(const ControlParams& at_master, const ControlParams& at_slave, Seconds slave_tick = tick)
      : master(make_supervised_master(at_master, 11, tick).value()),
        slave(make_supervised_slave(at_slave, 21, slave_tick).value()) {}

  void step(int ticks, const SiteRequests& pressed) {
    for (int i = 0; i < ticks; ++i) {
      const auto from_master = master.step({.requests = pressed});
      slave.take(from_master.packet);
      const auto from_slave = slave.step({.requests = pressed});
      master.take(from_slave.packet);
      master_record = from_master.record;
      slave_record = from_slave.record;
    }
  }
  void arm() {
    step(200, {});
    step(2, {.align = true});
    step(2, {});
    step(2, {.arm = true});
    step(5, {});
    step(20, {.dead_man = true});
  }
  [[nodiscard]] bool both_active() const {
    return master.state() == SiteState::active && slave.state() == SiteState::active;
  }
  [[nodiscard]] bool none_armed() const {
    return master.state() == SiteState::align && slave.state() == SiteState::align;
  }

  SupervisedMaster master;
  SupervisedSlave slave;
  SiteRecord master_record, slave_record;
};

struct Difference {
  std::function<void(ControlParams&)> change;
  std::string key, ours, theirs;  ///< as the changed site says it
};

TEST(Agreement, SitesThatWorkByTheSameParametersAreArmed) {
  TwoSites sites({}, {});
  sites.arm();
  EXPECT_TRUE(sites.both_active());
  EXPECT_EQ(sites.master_record.differs, 0);
  EXPECT_FALSE(first_disagreement(sites.master.agreement()));
}

TEST(Agreement, SitesThatWorkByOtherParametersAreNotArmedAndNameTheKeyAndBothValues) {
  const std::vector<Difference> differences{
      {[](ControlParams& c) { c.architecture = "position-position"; }, "control.architecture", "position-position",
       "position-force"},
      {[](ControlParams& c) { c.position_scale = 2.0; }, "control.position_scale", "2", "1"},
      {[](ControlParams& c) { c.force_gain = 0.5; }, "control.force_gain", "0.5", "1"},
      {[](ControlParams& c) { c.force_limit_N = 0.75; }, "control.force_limit_N", "0.75 N", "1 N"},
      {[](ControlParams& c) { c.slave_gate.force_limit_N = 20.0; }, "control.slave_gate.force_limit_N", "20 N", "10 N"},
      {[](ControlParams& c) { c.gate.energy.credit_J *= 2.0; }, "control.gate.energy.credit_J", {}, {}},
      {[](ControlParams& c) { c.own<PassivityParams>().reflected_force = ReflectedForce::servo; },
       "control.passivity.reflected_force", "servo", "tip"},
      {[](ControlParams& c) { c.supervision.watchdog.timeout_s = 0.3; }, "control.supervision.watchdog.timeout_s",
       "0.3 s", "0.1 s"},
      {[](ControlParams& c) { c.supervision.packets.longest_age_s = 0.5; }, "control.supervision.packets.longest_age_s",
       "0.5 s", "0.2 s"},
  };
  for (const Difference& difference : differences) {
    for (const bool at_master : {true, false}) {
      ControlParams plain, changed;
      difference.change(changed);
      TwoSites sites(at_master ? changed : plain, at_master ? plain : changed);
      sites.arm();
      EXPECT_TRUE(sites.none_armed()) << difference.key;
      EXPECT_EQ(static_cast<SiteCause>(sites.master_record.cause), SiteCause::disagreement) << difference.key;
      EXPECT_EQ(static_cast<SiteCause>(sites.slave_record.cause), SiteCause::disagreement) << difference.key;
      EXPECT_GT(sites.master_record.differs, 0);
      EXPECT_EQ(sites.slave_record.differs, sites.master_record.differs);
      const AgreementCheck& check = at_master ? sites.master.agreement() : sites.slave.agreement();
      EXPECT_TRUE(check.complete());
      const auto found = first_disagreement(check);
      ASSERT_TRUE(found) << difference.key;
      EXPECT_EQ(found->key, difference.key);
      if (difference.ours.empty()) continue;
      EXPECT_EQ(found->own, difference.ours);
      EXPECT_EQ(found->other, difference.theirs);
    }
  }
}

TEST(Agreement, EveryValueFindsACell) { EXPECT_LT(agreement_of({}, tick).size(), Agreement::most_cells); }

/// Keys of an architecture that was plugged in: one of each kind.
struct PluggedParams {
  double stiffness_N_per_m = 100.0;
  std::int64_t stages = 2;
  bool soft = false;
  ReflectedForce force = ReflectedForce::tip;
  static constexpr auto fields() {
    return List{
        field("stiffness_N_per_m", &PluggedParams::stiffness_N_per_m, units::newton_per_metre, positive, "Stiffness."),
        field("stages", &PluggedParams::stages, between(1.0, 5.0), "Stages."),
        field("soft", &PluggedParams::soft, "Softly."), field("force", &PluggedParams::force, "Which force.")};
  }
};

TEST(Agreement, SitesThatDifferInAKeyOfAnArchitectureThatWasPluggedInNameIt) {
  Architecture plugged = *find_architecture("position-force");
  plugged.name = "plugged";
  plugged.keys = own_keys<PluggedParams>("plugged", "Architecture plugged.");
  ASSERT_FALSE(register_architecture(plugged));
  using Params = PluggedParams;
  const std::vector<Difference> differences{
      {[](ControlParams& c) { c.own<Params>().stiffness_N_per_m = 90.0; }, "control.plugged.stiffness_N_per_m",
       "90 N/m", "100 N/m"},
      {[](ControlParams& c) { c.own<Params>().stages = 3; }, "control.plugged.stages", "3", "2"},
      {[](ControlParams& c) { c.own<Params>().soft = true; }, "control.plugged.soft", "true", "false"},
      {[](ControlParams& c) { c.own<Params>().force = ReflectedForce::servo; }, "control.plugged.force", "servo",
       "tip"},
  };
  for (const Difference& difference : differences) {
    ControlParams plain, changed;
    difference.change(changed);
    TwoSites sites(changed, plain);
    sites.arm();
    EXPECT_TRUE(sites.none_armed()) << difference.key;
    const auto found = first_disagreement(sites.master.agreement());
    ASSERT_TRUE(found) << difference.key;
    EXPECT_EQ(found->key, difference.key);
    EXPECT_EQ(found->own, difference.ours);
    EXPECT_EQ(found->other, difference.theirs);
  }
}

TEST(Agreement, SitesOfDifferentRatesAreNotArmed) {
  TwoSites sites({}, {}, Seconds{0.5e-3});
  sites.arm();
  EXPECT_TRUE(sites.none_armed());
  const auto found = first_disagreement(sites.slave.agreement());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->key, "servo.rate_Hz");
  EXPECT_EQ(found->own, "2000 Hz");
  EXPECT_EQ(found->other, "1000 Hz");
}

TEST(Agreement, WhatConcernsOneSiteOrItsHostAloneMayDiffer) {
  ControlParams other;
  other.model.motor.mass_kg *= 1.5;
  other.command_filter.frequency_Hz += 1.0;
  other.supervision.longest_stall_s = 0.3;
  TwoSites sites({}, other);
  sites.arm();
  EXPECT_TRUE(sites.both_active());
}

TEST(Agreement, ASlaveThatIsStartedAnewWithTheSameParametersIsArmed) {
  ControlParams changed;
  changed.force_gain = 0.5;
  TwoSites sites({}, changed);
  sites.arm();
  ASSERT_TRUE(sites.none_armed());
  sites.slave = make_supervised_slave({}, 22, tick).value();
  sites.arm();
  EXPECT_TRUE(sites.both_active());
  EXPECT_FALSE(sites.master.agreement().disagrees());
}

TEST(Agreement, TheDigestAloneDecidesAndNoCellOfAStrangerIsBelieved) {
  const Agreement own = agreement_of({}, tick);
  AgreementCheck check(own);
  EXPECT_FALSE(check.disagrees()) << "nobody was heard";
  check.take(5, {.digest = own.digest(), .cell = 4, .value = 1});
  EXPECT_FALSE(check.disagrees());
  EXPECT_FALSE(first_disagreement(check));
  check.take(6, {.digest = own.digest() + 1, .cell = ~std::uint64_t{0}, .value = 1});
  EXPECT_TRUE(check.disagrees());
  EXPECT_FALSE(first_disagreement(check)) << "it has not said where";
  std::set<std::uint64_t> digests{own.digest()};
  for (const double rate_Hz : {500.0, 1000.0 + 1e-3, 2000.0, 5000.0}) {
    EXPECT_TRUE(digests.insert(agreement_of({}, Seconds{1.0 / rate_Hz}).digest()).second) << rate_Hz;
  }
}

}  // namespace agreement_test
}  // namespace tactus::control
