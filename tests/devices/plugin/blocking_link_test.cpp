// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/devices/plugin/blocking_link.hpp>
#include <tactus/hardware/wire/talk.hpp>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace tactus::devices {
namespace blocking_link_test {

using namespace std::chrono_literals;
using station::DeviceHealth;

/// What the test and the driver, which the link owns, both see.
struct Seen {
  std::atomic<int> opened{0}, closed{0}, cycles{0};
  std::atomic<double> torque_Nm{0.0};
  std::atomic<int> enabled{0};
  std::atomic<bool> blocks{false};  ///< until it is false again
  std::atomic<bool> blocked{false};
};

class Driver final : public BlockingDriver {
 public:
  explicit Driver(std::shared_ptr<Seen> seen, std::function<Check(int cycle)> then = {}, Check opening = {})
      : seen_(std::move(seen)), then_(std::move(then)), opening_(std::move(opening)) {}
  std::size_t motors() const noexcept override { return 1; }
  MotorAbility ability(std::size_t) const noexcept override { return {.torque_Nm = 2.0}; }
  Check open() override {
    ++seen_->opened;
    return opening_;
  }
  Check exchange(std::span<const MotorCommand> commands, std::span<MotorReading> readings) override {
    while (seen_->blocks) {
      seen_->blocked = true;
      std::this_thread::sleep_for(1ms);
    }
    seen_->torque_Nm = commands[0].torque_Nm;
    seen_->enabled = static_cast<int>(commands[0].enabled);
    readings[0].position_rad = 0.25;
    readings[0].enabled = commands[0].enabled;
    const int cycle = ++seen_->cycles;
    return then_ ? then_(cycle) : Check{};
  }
  void close() noexcept override { ++seen_->closed; }

 private:
  std::shared_ptr<Seen> seen_;
  std::function<Check(int)> then_;
  Check opening_;
};

template <class Condition>
bool becomes(const Condition& condition) {
  for (int i = 0; i < 5000 && !condition(); ++i) std::this_thread::sleep_for(1ms);
  return condition();
}

BusCommands torque(double torque_Nm) {
  BusCommands commands;
  commands.motors[0] = {.torque_Nm = torque_Nm, .enabled = 1};
  commands.time_ns = wire::monotonic_ns();
  return commands;
}

constexpr Seconds patient{10.0};
constexpr double longest_silence_s = 5.0;

Error failure(const char* message) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = message, .place = {}};
}

TEST(BlockingLink, SendsCommandsWithinTheLimitAndStampsReadings) {
  const auto seen = std::make_shared<Seen>();
  auto link = *BlockingLink::start(std::make_unique<Driver>(seen), longest_silence_s);
  ASSERT_FALSE(link->wait_until_asked(patient));
  link->command(torque(1.5));
  EXPECT_TRUE(becomes([&] { return seen->torque_Nm == 1.5; }));
  link->command(torque(-7.0));
  EXPECT_TRUE(becomes([&] { return seen->torque_Nm == -2.0; }));
  const std::int64_t before_ns = wire::monotonic_ns();
  EXPECT_TRUE(becomes([&] { return link->newest()->motors[0].received_ns >= before_ns; }));
  EXPECT_EQ(link->newest()->motors[0].position_rad, 0.25);
  EXPECT_EQ(link->sheet(0).torque_limit_Nm, 2.0);
  // What is not a number removes the torque.
  link->command(torque(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_TRUE(becomes([&] { return seen->torque_Nm == 0.0 && seen->enabled == 0; }));
  link->stop();
  EXPECT_FALSE(link->running());
  EXPECT_EQ(seen->closed, 1);
}

TEST(BlockingLink, StopRemovesTheTorqueBeforeItCloses) {
  const auto seen = std::make_shared<Seen>();
  auto link = *BlockingLink::start(std::make_unique<Driver>(seen), longest_silence_s);
  ASSERT_FALSE(link->wait_until_asked(patient));
  link->command(torque(1.0));
  ASSERT_TRUE(becomes([&] { return seen->enabled == 1; }));
  link->stop();
  EXPECT_EQ(seen->enabled, 0);
  EXPECT_EQ(seen->torque_Nm, 0.0);
  EXPECT_EQ(seen->closed, 1);
}

TEST(BlockingLink, CommandsThatStopRemoveTheTorque) {
  const auto seen = std::make_shared<Seen>();
  auto link = *BlockingLink::start(std::make_unique<Driver>(seen), 0.02);
  ASSERT_FALSE(link->wait_until_asked(patient));
  BusCommands nothing;
  nothing.time_ns = wire::monotonic_ns();
  link->command(nothing);
  link->command(torque(1.0));
  ASSERT_TRUE(becomes([&] { return seen->cycles > 3; }));
  EXPECT_TRUE(becomes([&] { return seen->enabled == 0 && link->newest()->unheard == 1; }));
}

TEST(BlockingLink, ADriverThatThrowsEndsTheLinkWithItsReason) {
  const auto seen = std::make_shared<Seen>();
  auto driver = std::make_unique<Driver>(seen, [](int cycle) -> Check {
    if (cycle == 1) throw std::runtime_error("the robot reported a collision");
    return std::nullopt;
  });
  auto link = *BlockingLink::start(std::move(driver), longest_silence_s);
  const Check wrong = link->wait_until_asked(patient);
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->message, "the driver threw in exchange: the robot reported a collision");
  EXPECT_EQ(seen->closed, 1);
}

TEST(BlockingLink, ADriverThatCannotOpenSaysWhy) {
  const auto seen = std::make_shared<Seen>();
  auto link = *BlockingLink::start(
      std::make_unique<Driver>(seen, std::function<Check(int)>{}, failure("no robot at 10.0.0.2")), longest_silence_s);
  const Check wrong = link->wait_until_asked(patient);
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->message, "no robot at 10.0.0.2");
  EXPECT_EQ(link->newest()->state, BusState::refused);
  EXPECT_EQ(seen->cycles, 0);
  EXPECT_EQ(seen->closed, 1);
}

/// As `MotorBusDevice` judges it, which is what makes a site release its force.
DeviceHealth health_of(MotorBusDevice& device) {
  station::Tick tick;
  tick.began_ns = tick.deadline_ns = wire::monotonic_ns();
  device.read(tick);
  return device.health();
}

std::unique_ptr<MotorBusDevice> device_on(MotorLink& link) {
  MotorJoint joint;
  joint.lower_rad = -1.0;
  joint.upper_rad = 1.0;
  joint.velocity_limit_rad_per_s = 1.0;
  joint.torque_limit_Nm = 1.0;
  joint.torque_rate_limit_Nm_per_s = 10.0;
  return *MotorBusDevice::make(link, {.joints = Joints<MotorJoint>(1, joint)});
}

TEST(BlockingLink, ADriverThatBlocksMakesTheDeviceSilent) {
  const auto seen = std::make_shared<Seen>();
  auto link = *BlockingLink::start(std::make_unique<Driver>(seen), longest_silence_s);
  ASSERT_FALSE(link->wait_until_asked(patient));
  const auto device = device_on(*link);
  ASSERT_TRUE(becomes([&] { return health_of(*device) == DeviceHealth::good; }));
  seen->blocks = true;
  EXPECT_TRUE(becomes([&] { return health_of(*device) == DeviceHealth::not_responding; }));
  seen->blocks = false;
}

TEST(BlockingLink, ADriverThatFailsMakesTheDeviceSilentUntilItIsOpenedAgain) {
  const auto seen = std::make_shared<Seen>();
  std::atomic<bool> fails{false};
  auto link = *BlockingLink::start(
      std::make_unique<Driver>(seen, [&fails](int) { return fails ? Check(failure("cable")) : Check{}; }),
      longest_silence_s);
  ASSERT_FALSE(link->wait_until_asked(patient));
  const auto device = device_on(*link);
  ASSERT_TRUE(becomes([&] { return health_of(*device) == DeviceHealth::good; }));
  link->command(torque(1.0));
  ASSERT_TRUE(becomes([&] { return seen->enabled == 1; }));
  fails = true;
  ASSERT_TRUE(becomes([&] { return seen->closed > 0; }));
  EXPECT_TRUE(becomes([&] { return health_of(*device) == DeviceHealth::not_responding; }));
  ASSERT_TRUE(becomes([&] { return link->problem().has_value(); }));
  EXPECT_EQ(link->problem()->message, "cable");
  EXPECT_TRUE(link->running());
  fails = false;
  ASSERT_TRUE(becomes([&] { return !link->problem() && link->newest()->state == BusState::ready; }));
  EXPECT_EQ(seen->opened, seen->closed + 1);
  // Its commands are those from before: they count again once a cycle enables nothing.
  const int cycles = seen->cycles;
  ASSERT_TRUE(becomes([&] { return seen->cycles > cycles + 3; }));
  EXPECT_EQ(seen->enabled, 0);
  link->command(BusCommands{.motors = {}, .time_ns = wire::monotonic_ns()});
  ASSERT_TRUE(becomes([&] { return link->newest()->unheard == 0; }));
  link->command(torque(1.0));
  EXPECT_TRUE(becomes([&] { return seen->enabled == 1; }));
}

TEST(BlockingLink, ADriverThatCannotBeOpenedAgainEndsWhenItIsStopped) {
  const auto seen = std::make_shared<Seen>();
  std::atomic<bool> fails{false};
  auto link = *BlockingLink::start(
      std::make_unique<Driver>(seen, [&fails](int) { return fails ? Check(failure("cable")) : Check{}; }),
      longest_silence_s);
  ASSERT_FALSE(link->wait_until_asked(patient));
  fails = true;
  ASSERT_TRUE(becomes([&] { return link->problem().has_value(); }));
  // Though it can be opened, it cannot be driven: that stays reported, and no command reaches it.
  link->command(torque(1.0));
  bool always = true;
  ASSERT_TRUE(becomes([&] {
    always = always && link->problem() && link->newest()->state == BusState::asking && seen->enabled == 0;
    return seen->closed > 2;
  }));
  EXPECT_TRUE(always);
  link->stop();
  EXPECT_FALSE(link->running());
  EXPECT_EQ(seen->opened, seen->closed);
  EXPECT_TRUE(link->powered_motors().empty());
  EXPECT_EQ(link->problem()->message, "cable");
}

TEST(BlockingLink, ADriverThatStaysBlockedDoesNotKeepTheProgramFromEnding) {
  const auto seen = std::make_shared<Seen>();
  auto link = *BlockingLink::start(std::make_unique<Driver>(seen), longest_silence_s);
  ASSERT_FALSE(link->wait_until_asked(patient));
  seen->blocks = true;
  ASSERT_TRUE(becomes([&] { return seen->blocked.load(); }));
  link->stop();
  EXPECT_TRUE(link->running());  // its thread is left behind
  link.reset();
  seen->blocks = false;
  EXPECT_TRUE(becomes([&] { return seen->closed == 1; }));
}

}  // namespace blocking_link_test
}  // namespace tactus::devices
