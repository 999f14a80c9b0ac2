#include <tactus/control/protective_limits.hpp>

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

}  // namespace protective_limits_test
}  // namespace tactus::control
