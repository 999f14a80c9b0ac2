// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/interfaces/cli/guard_page.hpp>
#include <tactus/interfaces/cli/guarded_link.hpp>

#include <memory>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace tactus::cli {
namespace guarded_link_test {

using devices::BusCommands;
using devices::BusReadings;
using devices::GuardState;
using devices::Trouble;

constexpr std::int64_t ms = 1'000'000;

/// One motor, which has power one cycle after it is commanded to.
struct Motor {
  BusCommands commands;
  BusReadings readings;
  bool stuck = false;  ///< the thread of the bus

  void cycle(std::int64_t now_ns) {
    if (stuck) return;
    readings.state = devices::BusState::ready;
    ++readings.cycles;
    readings.time_ns = now_ns;
    readings.motors[0].enabled = commands.motors[0].enabled;
    readings.motors[0].received_ns = now_ns;
    ++readings.motors[0].answers;
  }
};

class FakeLink final : public devices::MotorLink {
 public:
  explicit FakeLink(Motor& motor) : motor_(&motor) {}
  [[nodiscard]] std::size_t motors() const noexcept override { return 1; }
  void command(const BusCommands& commands) noexcept override { motor_->commands = commands; }
  [[nodiscard]] std::optional<BusReadings> newest() const noexcept override { return motor_->readings; }
  [[nodiscard]] bool running() const noexcept override { return true; }
  void stop() override {}
  Check wait_until_asked(Seconds /*longest*/) override { return std::nullopt; }
  [[nodiscard]] devices::MotorSheet sheet(std::size_t /*motor*/) const override { return {}; }
  [[nodiscard]] std::vector<devices::PoweredMotor> powered_motors() const override { return {}; }

 private:
  Motor* motor_;
};

/// A servo thread, a bus and a guard in virtual time, a cycle each millisecond.
class GuardedMotor : public ::testing::Test {
 protected:
  /// So long, with power wanted or not.
  void run(std::int64_t lasting_ms, bool wanted) {
    for (std::int64_t i = 0; i < lasting_ms; ++i) {
      now_ns += ms;
      motor.cycle(now_ns);
      if (guard_lives) ++page.guard_beats;
      BusCommands commands;
      commands.motors[0].enabled = wanted ? 1 : 0;
      commands.time_ns = now_ns;
      last = link.newest();
      link.command(commands);
    }
  }
  [[nodiscard]] bool has_power() const { return motor.readings.motors[0].enabled != 0; }

  Motor motor;
  GuardPage page;
  GuardedLink link{std::make_unique<FakeLink>(motor), page};
  std::optional<BusReadings> last;
  std::int64_t now_ns = 1;
  bool guard_lives = true;
};

TEST_F(GuardedMotor, BeatsWhileItTicksAndTheBusEndsCycles) {
  run(100, true);
  EXPECT_TRUE(has_power());
  EXPECT_EQ(last->guard, GuardState::watches);
  EXPECT_EQ(page.powered, 1U);
  EXPECT_EQ(page.program_beats, 100U);
  // A servo thread that ticks on before a bus that is stuck does not hide that.
  motor.stuck = true;
  run(100, true);
  EXPECT_EQ(page.program_beats, 100U);
}

TEST_F(GuardedMotor, LosesItsPowerInTheTickAfterTheGuardHasEnded) {
  run(10, true);
  page.guard_ended = 1;
  run(2, true);
  EXPECT_EQ(last->guard, GuardState::gone);
  EXPECT_EQ(motor.commands.motors[0].enabled, 0);
  run(1, true);
  EXPECT_FALSE(has_power());
  run(1000, true);
  EXPECT_FALSE(has_power());
}

TEST_F(GuardedMotor, LosesItsPowerWhenTheGuardDoesNotBeatForItsTimeoutAndNotBefore) {
  run(10, true);
  guard_lives = false;
  run(guard_timeout_ns / ms - 1, true);
  EXPECT_TRUE(has_power());
  EXPECT_EQ(last->guard, GuardState::watches);
  run(5, true);
  EXPECT_FALSE(has_power());
  EXPECT_EQ(last->guard, GuardState::gone);
}

TEST_F(GuardedMotor, HasNoPowerAfterTheGuardHasActedUntilNothingIsWantedOnce) {
  run(10, true);
  ++page.taken;
  run(500, true);
  EXPECT_FALSE(has_power());
  EXPECT_EQ(last->guard, GuardState::acted);
  EXPECT_NE(page.acknowledged, page.taken);
  run(2, false);
  EXPECT_EQ(page.acknowledged, page.taken);
  run(10, true);
  EXPECT_TRUE(has_power());
  EXPECT_EQ(last->guard, GuardState::watches);
}

TEST_F(GuardedMotor, IsWatchedOnlyWhileItMayHavePower) {
  run(10, false);
  EXPECT_EQ(page.powered, 0U);
  run(10, true);
  EXPECT_EQ(page.powered, 1U);
  run(1, false);
  EXPECT_EQ(page.powered, 1U);
  run(2, false);
  EXPECT_EQ(page.powered, 0U);
  run(2, true);
  link.stop();
  EXPECT_EQ(page.powered, 0U);
}

TEST_F(GuardedMotor, OfADeviceIsLostWhateverWasWanted) {
  auto device = devices::MotorBusDevice::make(link, {.joints = Joints<devices::MotorJoint>(1)});
  ASSERT_TRUE(device);
  run(10, false);
  (*device)->read({.deadline_ns = now_ns, .began_ns = now_ns});
  EXPECT_NE((*device)->health(), station::DeviceHealth::lost);
  page.guard_ended = 1;
  (*device)->read({.deadline_ns = now_ns, .began_ns = now_ns});
  EXPECT_EQ((*device)->health(), station::DeviceHealth::lost);
  EXPECT_EQ((*device)->trouble().what, Trouble::guard_gone);
  page.guard_ended = 0;
  ++page.taken;
  // Nothing is wanted: the guard is answered, and the device is judged again.
  Joints<station::DeviceCommand> nothing(1);
  nothing[0].enabled = false;
  for (int tick = 0; tick < 2; ++tick) {
    (*device)->write(nothing);
    (*device)->read({.deadline_ns = now_ns, .began_ns = now_ns});
  }
  EXPECT_EQ(page.acknowledged, page.taken);
  EXPECT_NE((*device)->health(), station::DeviceHealth::lost);
}

TEST(BeatWatch, DoesNotCountTheTimeForWhichItsOwnLookWasLate) {
  BeatWatch watch(200 * ms, 10 * ms);
  std::int64_t now_ns = 1;
  EXPECT_TRUE(watch.alive(7, now_ns));
  // The machine stops both for 19 looks of a second each: no more than 10 ms count of each.
  for (int look = 0; look < 19; ++look) EXPECT_TRUE(watch.alive(7, now_ns += 1000 * ms));
  EXPECT_FALSE(watch.alive(7, now_ns += 1000 * ms));
  EXPECT_TRUE(watch.alive(8, now_ns += ms));
  for (int look = 0; look < 39; ++look) EXPECT_TRUE(watch.alive(8, now_ns += 5 * ms));
  EXPECT_FALSE(watch.alive(8, now_ns += 5 * ms));
  watch.restart();
  EXPECT_TRUE(watch.alive(8, now_ns += 5 * ms));
}

TEST(MappedGuardPage, IsSharedByTwoMappingsAndNothingElseIsTaken) {
  auto page = MappedGuardPage::create();
  ASSERT_TRUE(page);
  auto other = MappedGuardPage::adopt(dup(page->descriptor()));
  ASSERT_TRUE(other);
  (*page)->program_beats = 3;
  EXPECT_EQ((*other)->program_beats, 3U);
  // What can be shortened would end its readers.
  EXPECT_NE(ftruncate(page->descriptor(), 1), 0);
  EXPECT_FALSE(MappedGuardPage::adopt(open("/dev/null", O_RDWR | O_CLOEXEC)));
}

}  // namespace guarded_link_test
}  // namespace tactus::cli
