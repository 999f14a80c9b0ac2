// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/protective_limits.hpp>

#include <string>

#include <gtest/gtest.h>

namespace tactus::control {
namespace protective_limits_test {

/// Every number that is no time, a little tighter than by default.
template <Described T>
void tighten(T& params) {
  for_each_field<T>([&](const auto& f) {
    using Value = typename std::remove_cvref_t<decltype(f)>::value_type;
    if constexpr (Described<Value>) {
      tighten(params.*f.member);
    } else if constexpr (std::is_same_v<Value, double>) {
      if (std::string(f.unit.suffix) != "_s") params.*f.member *= 0.5;
    }
  });
}

ControlParams chosen() {
  ControlParams params;
  tighten(params.gate);
  tighten(params.slave_gate);
  params.supervision.force_sensor.residual_limit_N = 0.5;
  params.supervision.probe.force_N = 0.2;
  return params;
}

TEST(ProtectiveLimits, TheDefaultsAreRefusedAtBothSitesAndEachIsNamedWithItsValue) {
  for (const SiteRole role : {SiteRole::master, SiteRole::slave}) {
    const Check refused = refuse_default_limits({}, role);
    ASSERT_TRUE(refused);
    const std::string gate = role == SiteRole::master ? "gate" : "slave_gate";
    EXPECT_EQ(refused->parameter, gate + ".force_limit_N");
    for (const std::string& said : {std::string("10 N is the default"), gate + ".rate_limit_N_per_s = 1e+05 N/s",
                                    gate + ".velocity_limit_m_per_s = 50 m/s", gate + ".position_limit_m = 10 m",
                                    gate + ".encoder.fastest_m_per_s = 100 m/s", gate + ".energy.hold_above_J = 40 J",
                                    gate + ".thermal.continuous_force_N = 100 N",
                                    std::string("supervision.probe.force_N = 0 N"), std::string("set each")}) {
      EXPECT_NE(refused->message.find(said), std::string::npos) << said << "\nin " << refused->message;
    }
    EXPECT_EQ(refused->message.find("frozen_after_s"), std::string::npos) << "a time";
  }
}

TEST(ProtectiveLimits, LimitsThatSomebodyChosePassAndEachThatNobodyDidIsRefusedAlone) {
  EXPECT_FALSE(refuse_default_limits(chosen(), SiteRole::master));
  EXPECT_FALSE(refuse_default_limits(chosen(), SiteRole::slave));
  ControlParams params = chosen();
  params.slave_gate.velocity_limit_m_per_s = 50.0;
  EXPECT_FALSE(refuse_default_limits(params, SiteRole::master));
  EXPECT_EQ(refuse_default_limits(params, SiteRole::slave)->parameter, "slave_gate.velocity_limit_m_per_s");
  params = chosen();
  params.supervision.probe.force_N = 0.0;
  EXPECT_EQ(refuse_default_limits(params, SiteRole::master)->parameter, "supervision.probe.force_N");
}

TEST(ProtectiveLimits, WhatOnlyAForceSensorGivesAMeaningMayStayWhereThereIsNone) {
  ControlParams params = chosen();
  params.slave_gate.encoder.unbalanced_force_N = 200.0;
  EXPECT_EQ(refuse_default_limits(params, SiteRole::slave)->parameter, "slave_gate.encoder.unbalanced_force_N");
  params.slave_gate.reversal = {};
  params.supervision.force_sensor = {};
  params.slave_force.source = SlaveForceSource::momentum_observer;
  EXPECT_FALSE(refuse_default_limits(params, SiteRole::slave));
}

TEST(ProtectiveLimits, ASecondActuatorNeedsLimitsOfItsOwn) {
  ControlParams params = chosen();
  params.crossover.frequency_Hz = 30.0;
  EXPECT_EQ(refuse_default_limits(params, SiteRole::master)->parameter, "handle_gate.force_limit_N");
}

TEST(ProtectiveLimits, EveryThresholdThatNothingCanReachIsRefusedWithItsKeyItsValueAndTheLargestThatIsUseful) {
  ControlParams reachable = chosen();
  for (SafetyGate::Params* gate : {&reachable.gate, &reachable.slave_gate}) {
    gate->force_limit_N = 2.5;
    gate->velocity_limit_m_per_s = 4.0;
    gate->encoder.frozen_force_N = gate->encoder.unbalanced_force_N = 1.0;
    gate->reversal = {.force_N = 1.0, .gained_m_per_s = 2.0};
    gate->energy.drain_W = 1.0;
  }
  reachable.slave_force.source = SlaveForceSource::sensor;
  reachable.supervision.force_sensor.residual_limit_N = 1.0;
  for (const SiteRole role : {SiteRole::master, SiteRole::slave}) {
    const Check none = refuse_unreachable(reachable, role);
    EXPECT_FALSE(none) << describe(*none);
  }
  const auto refused = [&](auto change) {
    ControlParams params = reachable;
    change(params);
    const Check error = refuse_unreachable(params, SiteRole::slave);
    return error ? error->parameter + ": " + error->message : std::string();
  };
  const std::string reach =
      " can never be reached: the motor gives at most 2.5 N by slave_gate.force_limit_N or the limit of its device, "
      "whichever is lower; write at most 2.5 N";
  // It is a change of the force, which may go from one end to the other.
  EXPECT_EQ(refused([](auto& p) { p.slave_gate.encoder.frozen_force_N = 5.0; }), "");
  EXPECT_EQ(refused([](auto& p) { p.slave_gate.encoder.frozen_force_N = 5.5; }),
            "slave_gate.encoder.frozen_force_N: 5.5 N can never be reached: the motor gives at most 2.5 N by "
            "slave_gate.force_limit_N or the limit of its device, whichever is lower; write at most 5 N");
  EXPECT_EQ(refused([](auto& p) { p.slave_gate.encoder.unbalanced_force_N = 5.0; }),
            "slave_gate.encoder.unbalanced_force_N: 5 N" + reach);
  EXPECT_EQ(refused([](auto& p) { p.slave_gate.reversal.force_N = 3.0; }), "slave_gate.reversal.force_N: 3 N" + reach);
  EXPECT_EQ(refused([](auto& p) { p.supervision.force_sensor.residual_limit_N = 3.0; }),
            "supervision.force_sensor.residual_limit_N: 3 N" + reach);
  EXPECT_EQ(refused([](auto& p) { p.supervision.probe.force_N = 3.0; }), "supervision.probe.force_N: 3 N" + reach);
  EXPECT_EQ(
      refused([](auto& p) { p.slave_gate.reversal.gained_m_per_s = 5.0; }),
      "slave_gate.reversal.gained_m_per_s: 5 m/s can never be reached: the gate latches a velocity of 5 m/s, 1.25 "
      "times slave_gate.velocity_limit_m_per_s or the limit of its device, before; write at most 4 m/s");
  EXPECT_EQ(
      refused([](auto& p) { p.slave_gate.energy.drain_W = 12.5; }),
      "slave_gate.energy.hold_above_J: 20 J can never be reached: the motor gives at most 12.5 W, its force limit "
      "at 1.25 times its velocity limit, and slave_gate.energy.drain_W forgives 12.5 W; write a drain_W of at "
      "most 6.25 W");
  // Out of reach on purpose, or of a motor that gives no force.
  EXPECT_EQ(refused([](auto& p) { p.slave_gate.reversal = {}; }), "");
  EXPECT_EQ(refused([](auto& p) {
              p.slave_gate.force_limit_N = 1e-9;
              p.slave_gate.encoder.frozen_force_N = 5.0;
            }),
            "");
  EXPECT_EQ(refused([](auto& p) {
              p.slave_force.source = SlaveForceSource::momentum_observer;
              p.slave_gate.encoder.unbalanced_force_N = 5.0;
            }),
            "");
}

}  // namespace protective_limits_test
}  // namespace tactus::control
