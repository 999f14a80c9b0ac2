// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/supervised_site.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "tests/control/rubbing_device.hpp"
#include <gtest/gtest.h>

/// How a site comes to rest, and what it wants to see before it moves.
namespace tactus::control {
namespace stopping_test {

using test::Device;

constexpr double tick_s = 200e-6;
constexpr Seconds tick{tick_s};
constexpr double rate_N_per_s = 1000.0;

ControlParams params_of(double probe_N = 0.0) {
  ControlParams control;
  control.cancellation = CancellationMode::off;
  control.slave.proportional_N_per_m = 100.0;
  control.slave.derivative_N_s_per_m = 0.65;
  control.gate.rate_limit_N_per_s = control.slave_gate.rate_limit_N_per_s = rate_N_per_s;
  control.supervision.hold.release_s = 0.4;
  control.supervision.probe.force_N = probe_N;
  control.supervision.probe.duration_s = 0.16;
  return control;
}

/// Two sites with devices, a wire without delay and a wall before the slave, and the buttons.
struct Pair {
  explicit Pair(const ControlParams& params = params_of())
      : master(make_supervised_master(params, 11, tick).value()),
        slave(make_supervised_slave(params, 21, tick).value()) {}

  SupervisedMaster master;
  SupervisedSlave slave;
  Device handle{.mass_kg = 0.3, .friction_N = 0.05, .spring_N_per_m = 300.0, .damper_N_s_per_m = 5.0};
  Device tool{};
  double wall_at_m = 1.0;
  SiteRequests at_master, at_slave;
  bool cut = false;
  SupervisedMaster::Output master_out;
  SupervisedSlave::Output slave_out;

  void step(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      const double master_N = master_out.site.motor_force_N, slave_N = slave_out.site.motor_force_N;
      const double tip_N = std::max(0.0, 20000.0 * (tool.position_m - wall_at_m));
      master_out =
          master.step({.sensors = {.motor_position_m = handle.read_m(), .arrival = {}}, .requests = at_master});
      if (!cut) slave.take(master_out.packet);
      slave_out = slave.step(
          {.sensors = {.motor_position_m = tool.read_m(), .tip_force_N = tip_N, .arrival = {}}, .requests = at_slave});
      if (!cut) master.take(slave_out.packet);
      handle.push(master_out.site.motor_force_N);
      tool.push(slave_out.site.motor_force_N, -tip_N);
      ASSERT_LE(std::fabs(master_out.site.motor_force_N - master_N), rate_N_per_s * tick_s + 1e-12);
      ASSERT_LE(std::fabs(slave_out.site.motor_force_N - slave_N), rate_N_per_s * tick_s + 1e-12);
    }
  }
  void push(bool SiteRequests::*button) {
    at_master.*button = at_slave.*button = true;
    step(3);
    at_master.*button = at_slave.*button = false;
    step(3);
  }
  void arm() {
    at_master.dead_man = false;
    push(&SiteRequests::arm);
    at_master.dead_man = true;
    step(3);
  }
  void start() {
    step(10);
    push(&SiteRequests::align);
    arm();
  }
  /// Presses the slave against the wall with about 0.5 N.
  void press() {
    wall_at_m = 0.005;
    handle.anchor_m = 0.0101;
    step(5000);
    ASSERT_GT(slave_out.site.motor_force_N, 0.3);
  }
  [[nodiscard]] bool active() const {
    return master.state() == SiteState::active && slave.state() == SiteState::active;
  }
  [[nodiscard]] SiteCause master_cause() const { return static_cast<SiteCause>(master_out.record.cause); }
  [[nodiscard]] SiteCause slave_cause() const { return static_cast<SiteCause>(slave_out.record.cause); }
};

TEST(Hold, ASlaveInContactPressesNoLongerThanItsReleaseTimeAndItsForceFadesEvenly) {
  Pair pair;
  pair.start();
  pair.press();
  ASSERT_TRUE(pair.active());
  pair.cut = true;
  while (pair.slave.state() != SiteState::hold) pair.step();
  const double pressed_N = pair.slave_out.site.motor_force_N;
  pair.step(1000);
  EXPECT_NEAR(pair.slave_out.site.motor_force_N, 0.5 * pressed_N, 0.1 * pressed_N);
  pair.step(1001);
  EXPECT_EQ(pair.slave_out.site.motor_force_N, 0.0);
  EXPECT_EQ(pair.slave_out.record.share, 0.0);
  EXPECT_EQ(pair.master_out.site.motor_force_N, 0.0);
  pair.step(5000);
  EXPECT_EQ(pair.slave_out.site.motor_force_N, 0.0);
}

TEST(Hold, ASlaveThatWasMovedWhileItWasReleasedStandsWhereItIsWhenArmedAndComesSlowly) {
  Pair pair;
  pair.start();
  pair.cut = true;
  pair.step(3000);
  ASSERT_EQ(pair.slave.state(), SiteState::hold);
  pair.tool.position_m = -0.02;
  pair.cut = false;
  pair.step(10);
  pair.arm();
  ASSERT_TRUE(pair.active());
  double peak_N = 0.0;
  for (int i = 0; i < 500; ++i) {
    pair.step();
    peak_N = std::max(peak_N, std::fabs(pair.slave_out.site.motor_force_N));
  }
  EXPECT_LT(peak_N, 0.5) << "100 N/m times 20 mm would be 2 N";
  pair.step(5000);
  EXPECT_NEAR(pair.tool.position_m, pair.handle.position_m, 1e-3);
}

TEST(EmergencyStop, FromEveryStateTheForceGoesToZeroAtTheRateLimitThePowerGoesWithItAndOnlyClearLeadsOut) {
  for (const bool at_the_master : {false, true}) {
    for (const int until : {0, 1, 2, 3, 4}) {
      Pair pair;
      pair.step(10);
      if (until > 0) pair.push(&SiteRequests::align);
      if (until > 1) pair.push(&SiteRequests::arm);
      if (until > 2) pair.arm();
      if (until > 2) pair.press();
      if (until > 3) {
        pair.cut = true;
        pair.step(700);
      }
      const auto& record = at_the_master ? pair.master_out.record : pair.slave_out.record;
      const auto state = [&] { return at_the_master ? pair.master.state() : pair.slave.state(); };
      const auto force_N = [&] {
        return std::fabs(at_the_master ? pair.master_out.site.motor_force_N : pair.slave_out.site.motor_force_N);
      };
      const double before_N = force_N();
      EXPECT_EQ(record.enabled, until > 0);
      (at_the_master ? pair.at_master : pair.at_slave).emergency_stop = true;
      pair.step();
      EXPECT_EQ(state(), SiteState::fault) << until;
      EXPECT_EQ(static_cast<SiteCause>(record.cause), SiteCause::emergency_stop);
      EXPECT_EQ(static_cast<GateFault>(record.fault), GateFault::none);
      const int ramp = static_cast<int>(std::ceil(before_N / (rate_N_per_s * tick_s) + 1e-9));
      for (int i = 1; i < ramp; ++i) {
        EXPECT_TRUE(record.enabled);
        pair.step();
      }
      EXPECT_EQ(force_N(), 0.0);
      EXPECT_FALSE(record.enabled);
      pair.step(3);
      if (until > 2 && !pair.cut) {
        EXPECT_EQ(at_the_master ? pair.slave.state() : pair.master.state(), SiteState::hold);
        EXPECT_EQ(at_the_master ? pair.slave_cause() : pair.master_cause(), SiteCause::peer);
      }
      pair.push(&SiteRequests::clear);
      EXPECT_EQ(state(), SiteState::fault) << "still pressed";
      (at_the_master ? pair.at_master : pair.at_slave).emergency_stop = false;
      pair.step(100);
      EXPECT_EQ(state(), SiteState::fault) << "letting go starts nothing";
      EXPECT_FALSE(record.enabled);
      pair.push(&SiteRequests::clear);
      EXPECT_EQ(state(), SiteState::align);
      EXPECT_TRUE(record.enabled);
    }
  }
}

TEST(Enabled, AGateFaultTakesThePowerOnceTheForceIsZero) {
  Pair pair;
  pair.start();
  pair.press();
  pair.tool.position_m = std::nan("");
  pair.step();
  EXPECT_EQ(pair.slave_out.record.fault, static_cast<std::int64_t>(GateFault::not_finite));
  EXPECT_TRUE(pair.slave_out.record.enabled) << "the ramp needs it";
  pair.tool = {};
  pair.step(100);
  EXPECT_EQ(pair.slave_out.site.motor_force_N, 0.0);
  EXPECT_FALSE(pair.slave_out.record.enabled);
  EXPECT_TRUE(pair.master_out.record.enabled) << "a site that holds may be armed again";
}

// ---- sign probe ----

constexpr double probe_N = 0.3;

TEST(Probe, BothSitesFollowOnlyAfterTheirMotorsWereTriedAndAreAtHomeAndStillThen) {
  Pair pair(params_of(probe_N));
  pair.step(10);
  pair.push(&SiteRequests::align);
  pair.arm();
  double farthest_m = 0.0, peak_N = 0.0;
  int ticks = 0;
  for (; !pair.active() && ticks < 5000; ++ticks) {
    pair.step();
    farthest_m = std::max(farthest_m, std::fabs(pair.tool.position_m));
    peak_N = std::max(peak_N, std::fabs(pair.slave_out.site.motor_force_N));
  }
  EXPECT_TRUE(pair.active());
  EXPECT_LT(ticks * tick_s, 0.1 + 0.16 + 0.01) << "blend and duration";
  EXPECT_GT(ticks * tick_s, 0.155);
  EXPECT_GT(farthest_m, 1e-4);
  EXPECT_NEAR(peak_N, probe_N, 0.01);
  pair.handle.anchor_m = 0.01;
  pair.step(5000);
  EXPECT_NEAR(pair.tool.position_m, pair.handle.position_m, 1e-3) << "and the slave follows";
}

TEST(Probe, AMotorTheWrongWayRoundADeadOneAndOneThatGoesTooFarEndInHoldWithTheirCauseAndTheOtherSiteHoldsToo) {
  struct Case {
    Device device;
    SiteCause cause;
  };
  const Case cases[] = {{{.gain = -1.0}, SiteCause::probe_reversed},
                        {{.gain = 0.0}, SiteCause::probe_still},
                        {{.friction_N = 2.0}, SiteCause::probe_still},
                        {{.mass_kg = 0.003, .friction_N = 0.0}, SiteCause::probe_astray}};
  for (const Case& one : cases) {
    for (const bool at_the_master : {false, true}) {
      Pair pair(params_of(probe_N));
      Device& device = at_the_master ? pair.handle : pair.tool;
      const Device sound = device;
      device = one.device;
      pair.start();
      for (int i = 0; i < 2000; ++i) {
        pair.step();
        ASSERT_FALSE(pair.active());
      }
      EXPECT_EQ(pair.master.state(), SiteState::hold);
      EXPECT_EQ(pair.slave.state(), SiteState::hold);
      EXPECT_EQ(at_the_master ? pair.master_cause() : pair.slave_cause(), one.cause);
      EXPECT_EQ(at_the_master ? pair.slave_cause() : pair.master_cause(), SiteCause::peer);
      const ProbeFinding found = at_the_master ? pair.master.probe_finding() : pair.slave.probe_finding();
      const ProbeFinding of_other = at_the_master ? pair.slave.probe_finding() : pair.master.probe_finding();
      EXPECT_NE(found.report.verdict, ProbeVerdict::none);
      EXPECT_EQ(found.report.force_N, probe_N);
      EXPECT_EQ(of_other.report.verdict, ProbeVerdict::none) << "it only went with the other";
      const double stands_at_m = device.position_m;
      device = sound;
      device.position_m = stands_at_m;
      pair.step(6000);
      pair.arm();
      pair.step(1500);
      EXPECT_TRUE(pair.active()) << "mended and armed again";
      EXPECT_EQ(pair.master.probe_finding().report.verdict, ProbeVerdict::none);
      EXPECT_EQ(pair.slave.probe_finding().report.verdict, ProbeVerdict::none);
    }
  }
}

TEST(Probe, WithoutOneAMotorTheWrongWayRoundPasses) {
  Pair pair;
  pair.tool.gain = -1.0;
  pair.start();
  EXPECT_TRUE(pair.active());
}

TEST(Probe, ADeadManSwitchThatIsPressedAgainTriesNothingAnew) {
  Pair pair(params_of(probe_N));
  pair.start();
  pair.step(1500);
  ASSERT_TRUE(pair.active());
  pair.at_master.dead_man = false;
  pair.step(3);
  EXPECT_FALSE(pair.active());
  pair.at_master.dead_man = true;
  pair.step(3);
  EXPECT_TRUE(pair.active());
}

TEST(Probe, AnAnswerThatCannotComeInTimeIsRefused) {
  ControlParams params = params_of(probe_N);
  params.supervision.answer_within_s = 0.2;
  const auto made = make_supervised_slave(params, 1, tick);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().parameter, "supervision.answer_within_s");
  params.supervision.probe.force_N = 0.0;
  EXPECT_TRUE(make_supervised_slave(params, 1, tick));
}

}  // namespace stopping_test
}  // namespace tactus::control
