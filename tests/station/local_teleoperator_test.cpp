// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/kernel/station/make_device_guard.hpp>

#include <cmath>
#include <cstdint>
#include <string>

#include "carriage.hpp"
#include <gtest/gtest.h>

namespace tactus::station {
namespace {

using control::SiteRequests;
using control::SiteState;

/// A device that says what it is told to say.
class ScriptedDevice final : public Device {
 public:
  [[nodiscard]] DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  DeviceReading read(const Tick&) noexcept override { return reading; }
  void write(const DeviceCommand& given) noexcept override { command = given; }
  [[nodiscard]] DeviceHealth health() const noexcept override { return state; }

  explicit ScriptedDevice(const DeviceLimits& limits) : limits_(limits) {}
  DeviceReading reading;
  DeviceCommand command;
  DeviceHealth state = DeviceHealth::good;

 private:
  DeviceLimits limits_;
};

/// Two carriages, a hand and a wall, and a person who aligns, arms and presses.
struct Bench {
  Carriage master{limits}, slave{limits};
  LocalTeleoperator loop;
  std::int64_t number = 0;

  explicit Bench(const control::ControlParams& control = chosen(), const LinkParams& channel = {})
      : loop(LocalTeleoperator::make(control, channel, period, 0.0, master, slave).value()) {
    master.hand_N_per_m = 60.0;
    slave.wall_N_per_m = 500.0;
    slave.wall_m = 0.01;
  }
  void run(double duration_s, const SiteRequests& pressed) {
    for (const std::int64_t end = number + std::lround(duration_s / period.value); number < end; ++number) {
      loop.step(tick(number), pressed);
    }
  }
  [[nodiscard]] bool both(SiteState state) const {
    return loop.sites().master().state() == state && loop.sites().slave().state() == state;
  }
  void follow() {
    run(0.05, {});
    run(0.05, {.align = true});
    run(0.05, {.arm = true});
    run(0.6, {.dead_man = true});
  }
};

TEST(LocalTeleoperator, NothingMovesUntilAPersonHasArmedItAndHoldsTheSwitch) {
  Bench bench;
  bench.master.hand_m = 0.005;
  bench.run(0.3, {.dead_man = true});
  EXPECT_TRUE(bench.both(SiteState::configure));
  EXPECT_EQ(bench.slave.command.force_N, 0.0);
  EXPECT_FALSE(bench.slave.command.enabled);
  bench.run(0.05, {.align = true});
  bench.run(0.05, {.arm = true});
  bench.run(0.6, {});
  EXPECT_TRUE(bench.both(SiteState::armed)) << "both motors were tried, and the switch is not pressed";
  EXPECT_NEAR(bench.slave.position_m(), 0.0, 1e-3);
  bench.run(0.3, {.dead_man = true});
  EXPECT_TRUE(bench.both(SiteState::active));
  bench.master.hand_m = 0.015;
  bench.run(0.5, {.dead_man = true});
  EXPECT_GT(bench.slave.position_m(), bench.slave.wall_m) << "the slave follows the hand into the wall";
  EXPECT_LT(bench.master.command.force_N, -0.1) << "and the wall pushes the hand back";
  bench.run(0.5, {});
  EXPECT_TRUE(bench.both(SiteState::armed));
  EXPECT_EQ(bench.master.command.force_N, 0.0);
}

TEST(LocalTeleoperator, ThroughADelayedAndLossyChannelItFollowsAndASilentOneHoldsIt) {
  Bench bench(chosen(), {.to_slave = {.delay_s = 0.01, .jitter_s = 0.004, .loss_fraction = 0.05, .seed = 3},
                         .to_master = {.delay_s = 0.01, .jitter_s = 0.004, .loss_fraction = 0.05, .seed = 4}});
  bench.follow();
  EXPECT_TRUE(bench.both(SiteState::active));
  Bench cut(chosen(), {.to_slave = {.loss_fraction = 1.0}, .to_master = {}});
  cut.follow();
  EXPECT_FALSE(cut.both(SiteState::active));
  EXPECT_EQ(cut.master.command.force_N, 0.0);
}

TEST(LocalTeleoperator, PacketsThatAreTooOldAreNotApplied) {
  control::ControlParams control = chosen();
  control.supervision.packets.longest_age_s = 0.009;
  Bench late(control, {.to_slave = {.delay_s = 0.01}, .to_master = {}});
  late.follow();
  EXPECT_FALSE(late.both(SiteState::active));
  Bench early(control, {.to_slave = {.delay_s = 0.008}, .to_master = {}});
  early.follow();
  EXPECT_TRUE(early.both(SiteState::active));
}

TEST(LocalTeleoperator, AMotorWiredBackwardsIsFoundWhenItIsArmed) {
  class Reversed final : public Device {
   public:
    explicit Reversed(Device& device) : device_(&device) {}
    [[nodiscard]] DeviceLimits limits() const override { return device_->limits(); }
    DeviceReading read(const Tick& now) noexcept override { return device_->read(now); }
    void write(const DeviceCommand& given) noexcept override {
      device_->write({.force_N = -given.force_N, .enabled = given.enabled});
    }
    [[nodiscard]] DeviceHealth health() const noexcept override { return device_->health(); }

   private:
    Device* device_;
  };
  Carriage master(limits), carriage(limits);
  master.hand_N_per_m = 60.0;
  Reversed slave(carriage);
  auto loop = LocalTeleoperator::make(chosen(), {}, period, 0.0, master, slave).value();
  std::int64_t number = 0;
  const auto run = [&](std::int64_t ticks, const SiteRequests& pressed) {
    for (const std::int64_t end = number + ticks; number < end; ++number) loop.step(tick(number), pressed);
  };
  run(250, {});
  run(250, {.align = true});
  run(250, {.arm = true});
  run(5000, {.dead_man = true});
  EXPECT_NE(loop.sites().slave().state(), SiteState::active);
  EXPECT_NE(loop.sites().master().state(), SiteState::active);
}

TEST(LocalTeleoperator, OfADeviceThatReportsItsVelocityThresholdsFollowFromItsLimits) {
  DeviceLimits reports = limits;
  reports.velocity_step_m_per_s = 0.01;
  const control::SafetyGate::Params defaults, followed = tightened(defaults, reports),
                                              kept = tightened(defaults, limits);
  EXPECT_EQ(followed.encoder.frozen_force_N, 6.0) << "1.5 times 4 N";
  EXPECT_EQ(followed.motion.velocity_step_m_per_s, 0.01);
  EXPECT_EQ(followed.energy.drain_W, 4.0) << "half of 4 N at 2 m/s";
  EXPECT_EQ(kept.encoder.frozen_force_N, defaults.encoder.frozen_force_N);
  EXPECT_EQ(kept.motion.velocity_step_m_per_s, 0.0);
  EXPECT_EQ(kept.energy.drain_W, defaults.energy.drain_W);
  control::ControlParams control = chosen();
  control.slave_gate.encoder.frozen_force_N = defaults.encoder.frozen_force_N;
  Carriage simulation({.force_N = 5.0}, true), silent(limits), reporting(reports);
  EXPECT_EQ(LocalTeleoperator::make(control, {}, period, 0.0, simulation, silent).error().parameter,
            "control.slave_gate.encoder.frozen_force_N");
  EXPECT_TRUE(LocalTeleoperator::make(control, {}, period, 0.0, simulation, reporting));
}

TEST(LocalTeleoperator, ADeviceThatIsNotSimulatedIsRefusedUntilSomebodyChoseItsLimits) {
  DeviceLimits no_rate = limits;
  no_rate.rate_N_per_s = 0.0;
  Carriage simulation({.force_N = 5.0}, true), real(limits), unlimited(no_rate);
  const auto refused_for = [&](const control::ControlParams& control, Device& master, Device& slave) {
    const auto made = LocalTeleoperator::make(control, {}, period, 0.0, master, slave);
    return made ? std::string("nothing") : made.error().parameter;
  };
  EXPECT_EQ(refused_for({}, simulation, simulation), "nothing");
  EXPECT_EQ(refused_for({}, real, simulation), "control.gate.force_limit_N");
  EXPECT_EQ(refused_for({}, simulation, real), "control.slave_gate.force_limit_N");
  EXPECT_EQ(refused_for(chosen(), real, simulation), "nothing");
  EXPECT_EQ(refused_for(chosen(), simulation, real), "nothing");
  EXPECT_EQ(refused_for(chosen(), unlimited, simulation), "master.rate_N_per_s");
  // The device gives 4 N, the gates 5 N: changes between twice the one and twice the other are out of reach.
  control::ControlParams unreachable = chosen();
  unreachable.gate.encoder.frozen_force_N = unreachable.slave_gate.encoder.frozen_force_N = 8.5;
  EXPECT_EQ(refused_for(unreachable, simulation, simulation), "nothing");
  EXPECT_EQ(refused_for(unreachable, real, simulation), "control.gate.encoder.frozen_force_N");
  EXPECT_EQ(refused_for(unreachable, simulation, real), "control.slave_gate.encoder.frozen_force_N");
}

TEST(LocalTeleoperator, ADeviceThatIsNotSimulatedStandsBehindItsWall) {
  Bench bench;
  bench.follow();
  ASSERT_TRUE(bench.both(SiteState::active));
  EXPECT_LE(bench.slave.largest_step_N, 1000.0 * period.value * (1.0 + 1e-9));
  bench.slave.carry_to(-0.051);
  bench.run(0.05, {.dead_man = true});
  EXPECT_EQ(bench.slave.command.force_N, 0.0);
  EXPECT_FALSE(bench.slave.command.enabled);
  EXPECT_FALSE(bench.loop.healthy()) << "its site let go too";
}

TEST(LocalTeleoperator, LettingGoEndsWithoutAForceAndWithoutAStepInIt) {
  Bench bench;
  bench.follow();
  bench.master.hand_m = 0.02;
  bench.run(0.5, {.dead_man = true});
  ASSERT_LT(bench.master.command.force_N, -0.1);
  bench.master.largest_step_N = 0.0;
  int ticks = 0;
  while (ticks < 5000 && (ticks == 0 || !bench.loop.at_rest())) {
    bench.loop.step_to_rest(tick(bench.number++));
    ++ticks;
  }
  EXPECT_LT(ticks, 5000);
  EXPECT_EQ(bench.master.command.force_N, 0.0);
  EXPECT_LE(bench.master.largest_step_N, 1000.0 * period.value * (1.0 + 1e-9));
}

TEST(LocalTeleoperator, ASiteWhoseDeviceIsLostLetsGo) {
  Bench bench;
  bench.follow();
  bench.master.hand_m = 0.02;
  bench.run(0.3, {.dead_man = true});
  ASSERT_GT(bench.slave.command.force_N, 0.1);
  bench.slave.state = DeviceHealth::lost;
  bench.run(0.4, {.dead_man = true});
  EXPECT_EQ(bench.slave.command.force_N, 0.0);
  EXPECT_FALSE(bench.loop.healthy());
}

TEST(LocalTeleoperator, ADeviceThatIsSilentIsAHoldWithoutForceAndNoFault) {
  Bench bench;
  bench.follow();
  bench.master.hand_m = 0.02;
  bench.run(0.3, {.dead_man = true});
  ASSERT_GT(bench.slave.command.force_N, 0.1);
  bench.slave.state = DeviceHealth::degraded;
  bench.run(0.1, {.dead_man = true});
  EXPECT_TRUE(bench.both(SiteState::active)) << "an old reading alone stops nobody";
  bench.slave.state = DeviceHealth::not_responding;
  bench.run(0.4, {.dead_man = true});
  EXPECT_TRUE(bench.both(SiteState::hold));
  EXPECT_EQ(bench.loop.sites().slave().cause(), control::SiteCause::device);
  EXPECT_EQ(bench.loop.sites().master().cause(), control::SiteCause::peer);
  EXPECT_EQ(bench.slave.command.force_N, 0.0);
  EXPECT_FALSE(bench.slave.command.enabled);
  EXPECT_TRUE(bench.loop.healthy());
  bench.master.hand_m = 0.0;
  bench.run(0.5, {.arm = true});
  EXPECT_FALSE(bench.both(SiteState::armed)) << "not while it is silent";
  bench.slave.state = DeviceHealth::good;
  bench.run(0.05, {});
  bench.run(0.05, {.arm = true});
  bench.run(0.6, {.dead_man = true});
  EXPECT_TRUE(bench.both(SiteState::active));
}

TEST(BareTeleoperator, DrivesNoDeviceThatIsNotSimulated) {
  Carriage simulation({.force_N = 5.0}, true), real(limits);
  const auto refused = BareTeleoperator::make(chosen(), {}, period, 0.0, simulation, real);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "slave");
  EXPECT_TRUE(BareTeleoperator::make(chosen(), {}, period, 0.0, simulation, simulation));
}

TEST(BareTeleoperator, TheGateIsTightenedToWhatTheDeviceCanDo) {
  ScriptedDevice master({.force_N = 0.25});
  ScriptedDevice slave({.force_N = 3.0});
  control::ControlParams control;
  control.force_limit_N = 5.0;
  control.force_gain = 1.0;
  auto loop = BareTeleoperator::make(control, {}, period, 0.0, master, slave);
  ASSERT_TRUE(loop);
  slave.reading.force_N = 4.0;
  slave.reading.position_m = -1.0;
  for (std::int64_t number = 0; number < 100; ++number) loop->step(tick(number), 1.0);
  EXPECT_DOUBLE_EQ(master.command.force_N, -0.25);
  EXPECT_DOUBLE_EQ(slave.command.force_N, 3.0);
  loop->release();
  EXPECT_EQ(master.command.force_N, 0.0);
  EXPECT_EQ(slave.command.force_N, 0.0);
}

TEST(BareTeleoperator, ASiteWhoseDeviceIsSilentLetsGo) {
  ScriptedDevice master({.force_N = 5.0});
  ScriptedDevice slave({.force_N = 5.0});
  auto loop = BareTeleoperator::make({}, {}, period, 0.0, master, slave);
  ASSERT_TRUE(loop);
  slave.reading.position_m = -0.01;
  for (std::int64_t number = 0; number < 50; ++number) loop->step(tick(number), 1.0);
  EXPECT_GT(slave.command.force_N, 0.1);
  slave.state = DeviceHealth::not_responding;  // which nothing but its gate can act on
  for (std::int64_t number = 50; number < 2000; ++number) loop->step(tick(number), 1.0);
  EXPECT_EQ(slave.command.force_N, 0.0);
  EXPECT_FALSE(loop->healthy());
}

}  // namespace
}  // namespace tactus::station
