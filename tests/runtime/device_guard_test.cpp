// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/station/device_guard.hpp>
#include <tactus/runtime/servo/shared_device.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::runtime {
namespace device_guard_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t period_ns = 200'000;
constexpr double period_s = 1e-9 * static_cast<double>(period_ns);
constexpr Seconds timeout{0.004};  ///< 20 ticks
constexpr station::DeviceLimits limits{.force_N = 2.0,
                                       .handle_force_N = 0.5,
                                       .rate_N_per_s = 1000.0,  // 0.2 N a tick
                                       .velocity_m_per_s = 1.0,
                                       .position_m = 0.1};

station::Tick tick(std::int64_t number) {
  return {.number = number, .deadline_ns = number * period_ns, .began_ns = number * period_ns};
}

/// What reached the motor, held against the limits by the test itself.
class Motor final : public station::Device {
 public:
  [[nodiscard]] station::DeviceLimits limits() const override { return stated; }
  station::DeviceReading read(const station::Tick&) noexcept override { return reading; }
  void write(const station::DeviceCommand& given) noexcept override {
    for (const auto& [force_N, before_N, limit_N] :
         {std::tuple{given.force_N, now.force_N, stated.force_N},
          std::tuple{given.handle_force_N, now.handle_force_N, stated.handle_force_N}}) {
      within = within && std::isfinite(force_N) && std::fabs(force_N) <= limit_N &&
               std::fabs(force_N - before_N) <= stated.rate_N_per_s * period_s * (1.0 + 1e-6);
    }
    within = within && (given.enabled || (given.force_N == 0.0 && given.handle_force_N == 0.0));
    most_N = std::max(most_N, std::fabs(given.force_N));
    now = given;
  }
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }

  station::DeviceLimits stated = device_guard_test::limits;
  station::DeviceReading reading;
  station::DeviceCommand now;
  bool within = true;
  double most_N = 0.0;
};

TEST(DeviceGuard, WhatIsWithinTheLimitsPassesToTheBitAlsoWhereItIsExactlyAtThem) {
  station::DeviceGuard guard(limits, timeout);
  (void)guard.pass({}, tick(0));
  double force_N = 0.0;
  for (std::int64_t n = 1; n <= 1000; ++n) {
    force_N += (n / 10) % 2 == 0 ? 0.2 : -0.2;
    const station::DeviceCommand wanted{.force_N = force_N, .handle_force_N = -0.25 * force_N};
    const station::DeviceCommand given = guard.pass(wanted, tick(n));
    ASSERT_EQ(given.force_N, wanted.force_N) << n;
    ASSERT_EQ(given.handle_force_N, wanted.handle_force_N) << n;
    ASSERT_TRUE(given.enabled);
  }
  EXPECT_EQ(guard.cause(), station::ReleaseCause::none);
  EXPECT_EQ(guard.held_back(), 0);
}

TEST(DeviceGuard, ASlipIsHeldBackAndForgivenAndWhoInsistsIsLetGoOf) {
  station::DeviceGuard guard(limits, timeout);
  std::int64_t number = 0;
  const auto next = [&] { return tick(++number); };
  (void)guard.pass({}, tick(number));
  for (int round = 0; round < 100; ++round) {
    EXPECT_DOUBLE_EQ(guard.pass({.handle_force_N = 0.6}, next()).handle_force_N, 0.2);
    (void)guard.pass({}, next());
  }
  EXPECT_EQ(guard.cause(), station::ReleaseCause::none);
  EXPECT_EQ(guard.held_back(), 100);
  int ticks = 0;
  for (; guard.cause() == station::ReleaseCause::none && ticks < 100; ++ticks)
    (void)guard.pass({.force_N = 2.1}, next());
  EXPECT_EQ(guard.cause(), station::ReleaseCause::force);
  EXPECT_EQ(ticks, 21);
  // From 2 N at 0.2 N a tick, then without power, and nothing brings it back but a new arming.
  for (int left = 1; left < 40; ++left) {
    const station::DeviceCommand given = guard.pass({.force_N = 1.0}, next());
    EXPECT_NEAR(given.force_N, std::max(0.0, 2.0 - 0.2 * left), 1e-6) << left;
    EXPECT_EQ(given.enabled, given.force_N != 0.0);
  }
  guard.rearm();
  EXPECT_EQ(guard.pass({.force_N = 0.1}, next()).force_N, 0.1);
}

TEST(DeviceGuard, ASlowRateLimitKeepsNoForcePressingAfterAStop) {
  station::DeviceLimits slow = limits;
  slow.rate_N_per_s = 0.5;  // 0.1 mN a tick
  for (const bool by_command : {true, false}) {
    station::DeviceGuard guard(slow, Seconds{10.0});
    std::int64_t number = 0;
    (void)guard.pass({}, tick(number));
    double given_N = 0.0;
    while (given_N < 1.0) given_N = guard.pass({.force_N = given_N + 1e-4}, tick(++number)).force_N;
    const std::int64_t began = number;
    // A gate that stops commands less and less; a device without power is asked for nothing.
    while (given_N != 0.0 && number < began + 5000) {
      const double wanted_N = std::max(0.0, given_N - 2.0 / 0.25 * period_s);
      given_N = guard.pass({.force_N = by_command ? wanted_N : 0.0, .enabled = by_command}, tick(++number)).force_N;
    }
    EXPECT_LE(static_cast<double>(number - began) * period_s, 0.126) << "half of 0.25 s from half of the limit";
    EXPECT_EQ(guard.cause(), station::ReleaseCause::none);
    EXPECT_NEAR(guard.pass({.force_N = -1.0}, tick(++number)).force_N, -1e-4, 1e-12) << "it grows at the rate limit";
  }
}

TEST(DeviceGuard, TicksThatWereMissedEarnNoJump) {
  station::DeviceGuard guard(limits, timeout);
  (void)guard.pass({}, tick(0));
  station::Tick late = tick(10);
  late.missed = 9;
  EXPECT_DOUBLE_EQ(guard.pass({.force_N = 2.0}, late).force_N, 0.2);
}

TEST(DeviceGuard, ItMeasuresSpeedItselfAndAnEncodersStepIsNoSpeed) {
  const auto cause_at = [](double velocity_m_per_s, double ticks_jump_m) {
    station::DeviceGuard guard(limits, timeout);
    for (std::int64_t n = 0; n < 200 && guard.cause() == station::ReleaseCause::none; ++n) {
      const double true_m =
          -0.05 + velocity_m_per_s * period_s * static_cast<double>(n) + (n == 50 ? ticks_jump_m : 0.0);
      guard.observe(1e-4 * std::floor(true_m / 1e-4), tick(n));
    }
    return guard.cause();
  };
  EXPECT_EQ(cause_at(0.9, 0.0), station::ReleaseCause::none)
      << "though a count of 0.1 mm in a tick looks like 0.5 m/s more";
  EXPECT_EQ(cause_at(1.1, 0.0), station::ReleaseCause::velocity);
  EXPECT_EQ(cause_at(0.0, 0.004), station::ReleaseCause::none);
  EXPECT_EQ(cause_at(0.0, 0.006), station::ReleaseCause::velocity) << "a jump of what 5 ms allow";
  EXPECT_EQ(cause_at(0.0, nan), station::ReleaseCause::not_finite);
  station::DeviceGuard guard(limits, timeout);
  guard.observe(-0.1, tick(0));
  EXPECT_EQ(guard.cause(), station::ReleaseCause::none);
  guard.observe(-0.1001, tick(1));
  EXPECT_EQ(guard.cause(), station::ReleaseCause::position);
}

TEST(DeviceGuard, ItMeasuresSpeedOverTheTimeBetweenMeasurements) {
  // At 0.9 of the limit, a bus that stands still for 20 ms: what comes after that is no jump, but for who takes it for
  // new at each tick.
  const auto cause_at = [](bool age_is_told) {
    station::DeviceGuard guard(limits, timeout);
    for (std::int64_t n = 0; n < 500; ++n) {
      const double now_s = period_s * static_cast<double>(n);
      const double measured_s = now_s > 0.05 && now_s < 0.07 ? 0.05 : now_s;
      guard.observe(-0.05 + 0.9 * measured_s, tick(n), age_is_told ? now_s - measured_s : 0.0);
    }
    return guard.cause();
  };
  EXPECT_EQ(cause_at(true), station::ReleaseCause::none);
  EXPECT_EQ(cause_at(false), station::ReleaseCause::velocity);
  station::DeviceGuard guard(limits, timeout);
  guard.observe(0.0, tick(0), nan);
  EXPECT_EQ(guard.cause(), station::ReleaseCause::not_finite);
}

/// Controllers that are alive and wrong: what each commands at a tick.
struct Wrong {
  const char* name;
  std::function<double(std::int64_t tick)> force_N;
  station::ReleaseCause cause;
};
std::vector<Wrong> wrong_controllers() {
  const auto random = std::make_shared<signal::Random>(5);
  return {{"no number", [](std::int64_t n) { return n < 50 ? 1.0 : nan; }, station::ReleaseCause::not_finite},
          {"infinity", [](std::int64_t) { return std::numeric_limits<double>::infinity(); },
           station::ReleaseCause::not_finite},
          {"a million newtons", [](std::int64_t) { return 1e6; }, station::ReleaseCause::force},
          {"minus a million newtons", [](std::int64_t) { return -1e6; }, station::ReleaseCause::force},
          {"the limit to and fro", [](std::int64_t n) { return n % 2 == 0 ? 2.0 : -2.0; }, station::ReleaseCause::rate},
          {"anything", [random](std::int64_t) { return 1e3 * (static_cast<double>(random->bits() % 2001) - 1000.0); },
           station::ReleaseCause::force}};
}

TEST(GuardedDevice, WhateverAWrongControllerWritesTheMotorStaysWithinItsLimitsAndIsSwitchedOff) {
  for (const Wrong& wrong : wrong_controllers()) {
    Motor motor;
    station::GuardedDevice device(motor, timeout);
    for (std::int64_t n = 0; n < 200; ++n) {
      (void)device.read(tick(n));
      device.write({.force_N = n == 0 ? 0.0 : wrong.force_N(n)});
    }
    EXPECT_TRUE(motor.within) << wrong.name;
    EXPECT_EQ(device.guard().cause(), wrong.cause) << wrong.name;
    EXPECT_EQ(device.health(), station::DeviceHealth::lost) << wrong.name;
    EXPECT_FALSE(motor.now.enabled) << wrong.name;
  }
}

TEST(GuardedDevice, AMotorThatIsGivenNothingMoreIsSwitchedOffAndOneThatRunsAwayToo) {
  Motor motor;
  station::GuardedDevice device(motor, timeout);
  for (std::int64_t n = 0; n < 300; ++n) {
    (void)device.read(tick(n));
    if (n < 100) device.write({.force_N = std::min(1.0, 0.1 * static_cast<double>(n))});
    if (n == 119) {
      EXPECT_EQ(motor.now.force_N, 1.0) << "within timeout";
    }
  }
  EXPECT_TRUE(motor.within);
  EXPECT_EQ(device.guard().cause(), station::ReleaseCause::timed_out);
  EXPECT_FALSE(motor.now.enabled);

  Motor fast;
  station::GuardedDevice around(fast, timeout);
  for (std::int64_t n = 0; n < 300; ++n) {
    fast.reading.position_m = -0.09 + 2.0 * period_s * static_cast<double>(n);
    (void)around.read(tick(n));
    around.write({.force_N = 0.1});
    if (n == 50) {
      EXPECT_FALSE(fast.now.enabled);
    }
  }
  EXPECT_EQ(around.guard().cause(), station::ReleaseCause::velocity);
}

/// The owner's side with its motor, and whatever lies in the slots.
struct Owned {
  std::unique_ptr<DeviceSlots> slots = std::make_unique<DeviceSlots>();
  Motor motor;
  DeviceServer owner{*slots, timeout, limits};
  SharedDevice controller{*slots, limits, timeout};

  Owned() {
    owner.begin(1);
    controller.begin(1);
    step(0);
  }
  void step(std::int64_t number) {
    motor.write(owner.command(tick(number)));
    owner.publish(tick(number), number, motor.read(tick(number)));
  }
  void tell(double force_N, std::int64_t of_tick, std::int64_t time_ns) const {
    slots->commands.publish({.force_N = force_N, .enabled = 1, .tick = of_tick, .time_ns = time_ns, .session = 1});
  }
};

TEST(DeviceServer, WhateverAWrongControllerTellsTheMotorStaysWithinItsLimitsAndTheControllerHearsWhy) {
  for (const Wrong& wrong : wrong_controllers()) {
    Owned both;
    for (std::int64_t n = 1; n < 200; ++n) {
      (void)both.controller.read(tick(n));
      both.controller.write({.force_N = wrong.force_N(n)});
      both.step(n);
    }
    EXPECT_TRUE(both.motor.within) << wrong.name;
    EXPECT_FALSE(both.motor.now.enabled) << wrong.name;
    EXPECT_TRUE(both.owner.gave_up()) << wrong.name;
    EXPECT_EQ(both.controller.health(), station::DeviceHealth::lost) << wrong.name;
    EXPECT_TRUE(both.controller.given_up_by_owner()) << wrong.name;
    EXPECT_EQ(both.controller.owners_cause(), wrong.cause) << wrong.name;
  }
}

TEST(DeviceServer, CommandsThatSomethingRepeatsAreSilenceWhateverTimeTheyBear) {
  struct Stale {
    const char* name;
    std::int64_t (*tick)(std::int64_t now);
    std::int64_t (*time_ns)(std::int64_t now);
  };
  constexpr auto stands = [](std::int64_t now) { return std::min<std::int64_t>(now, 30); };
  for (const Stale& stale :
       {Stale{"an old time", [](std::int64_t now) { return now; },
              [](std::int64_t now) { return period_ns * std::min<std::int64_t>(now, 30); }},
        Stale{"an old tick under a new time", stands, [](std::int64_t now) { return period_ns * now; }}}) {
    Owned both;
    for (std::int64_t n = 1; n < 200; ++n) {
      both.tell(std::min(1.5, 0.1 * static_cast<double>(n)), stale.tick(n), stale.time_ns(n));
      both.step(n);
      if (n <= 50) {
        EXPECT_FALSE(both.owner.gave_up()) << stale.name << ", tick " << n;
      }
    }
    EXPECT_TRUE(both.motor.within) << stale.name;
    EXPECT_EQ(both.motor.most_N, 1.5) << stale.name;
    EXPECT_EQ(both.owner.guard().cause(), station::ReleaseCause::timed_out) << stale.name;
    EXPECT_FALSE(both.motor.now.enabled) << stale.name;
  }
}

TEST(DeviceServer, AControllerThatSaysNothingFindsNoPower) {
  Owned both;
  for (std::int64_t n = 1; n < 100; ++n) both.step(n);
  EXPECT_FALSE(both.motor.now.enabled);
  EXPECT_FALSE(both.owner.gave_up()) << "nobody was there yet";
}

TEST(DeviceGuard, ADeviceThatIsNotSimulatedStatesItsLimits) {
  Motor motor;
  EXPECT_FALSE(station::check_limits(motor));
  const auto expect_named = [&motor](double station::DeviceLimits::*member, double value, const char* name) {
    motor.stated = limits;
    motor.stated.*member = value;
    const Check refused = station::check_limits(motor);
    ASSERT_TRUE(refused) << name;
    EXPECT_EQ(refused->parameter, name);
  };
  expect_named(&station::DeviceLimits::force_N, 0.0, "force_N");
  expect_named(&station::DeviceLimits::rate_N_per_s, 0.0, "rate_N_per_s");
  expect_named(&station::DeviceLimits::velocity_m_per_s, nan, "velocity_m_per_s");
  expect_named(&station::DeviceLimits::position_m, -1.0, "position_m");
  motor.stated = limits;
  motor.stated.handle_force_N = 0.0;
  EXPECT_FALSE(station::check_limits(motor)) << "not every device has a second actuator";
}

}  // namespace device_guard_test
}  // namespace tactus::runtime
