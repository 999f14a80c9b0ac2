// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/inverse3/inverse3_link.hpp>
#include <tactus/hardware/devices/inverse3/messages.hpp>
#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/emulation/inverse3/inverse3_server.hpp>
#include <tactus/hardware/wire/talk.hpp>

#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <thread>

#include <gtest/gtest.h>

/// The client against the emulated service, at the real clock.
namespace tactus::devices::inverse3 {
namespace link_test {

using emulation::inverse3::Inverse3Server;
using emulation::inverse3::Inverse3Service;
using station::DeviceHealth;

constexpr Seconds long_enough{20.0};

Inverse3Server serve(const Inverse3Service::Params& params) {
  auto server = Inverse3Server::start(params, 0);
  EXPECT_TRUE(server.ok());
  return *std::move(server);
}

std::unique_ptr<Inverse3Link> link_to(const Inverse3Server& server, std::vector<std::int64_t> axes = {1, 2, 3}) {
  auto link = Inverse3Link::start({.address = "127.0.0.1:" + std::to_string(server.port()),
                                   .device = {},
                                   .axes = std::move(axes),
                                   .silence_s = 1.0});
  EXPECT_TRUE(link.ok());
  return *std::move(link);
}

MotorJoint wide() {
  MotorJoint joint;
  joint.lower_rad = -1000.0;
  joint.upper_rad = 1000.0;
  joint.velocity_limit_rad_per_s = 1000.0;
  joint.torque_limit_Nm = 5.0;
  return joint;
}

/// Ticks of a device, until something holds. False where it never does.
bool tick_until(MotorBusDevice& device, const Joints<station::DeviceCommand>& command,
                const std::function<bool(const Joints<station::DeviceReading>&)>& holds) {
  static std::int64_t number = 0;
  const std::int64_t until_ns = wire::monotonic_ns() + std::int64_t{10'000'000'000};
  while (wire::monotonic_ns() < until_ns) {
    const std::int64_t now_ns = wire::monotonic_ns();
    const auto reading = device.read({.number = ++number, .deadline_ns = now_ns, .began_ns = now_ns});
    if (holds(reading)) return true;
    device.write(command);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

const Joints<station::DeviceCommand> no_power(3, {.force_N = 0.0, .enabled = false});

TEST(Inverse3Link, ThreeAxesBecomeADeviceInBothDialects) {
  for (const auto& [dialect, version] : enumerators(emulation::inverse3::Dialect{})) {
    const auto server = serve({.dialect = dialect});
    // z, x, y are the joints; the second points against its axis.
    const auto link = link_to(server, {3, 1, 2});
    const Check wrong = link->wait_until_asked(long_enough);
    ASSERT_FALSE(wrong) << describe(*wrong);
    Joints<MotorJoint> joints(3, wide());
    joints[1].sign = -1;
    auto device = MotorBusDevice::make(*link, {.joints = joints, .late_s = 0.5, .silence_s = 2.0});
    ASSERT_TRUE(device);
    EXPECT_TRUE(tick_until(**device, no_power, [&](const auto&) { return (*device)->health() == DeviceHealth::good; }));
    Joints<station::DeviceCommand> push = no_power;
    for (station::DeviceCommand& joint : push) joint.enabled = true;
    push[0].force_N = 1.0;
    push[1].force_N = 2.0;
    Joints<station::DeviceReading> last;
    EXPECT_TRUE(tick_until(**device, push, [&](const auto& reading) {
      last = reading;
      return reading[0].position_m > 0.02;
    }));
    // Twice the force, twice the way; each in the direction in which its joint was pushed.
    EXPECT_NEAR(last[1].position_m / last[0].position_m, 2.0, 0.1);
    EXPECT_EQ(last[2].position_m, 0.0);
    EXPECT_EQ((*device)->health(), DeviceHealth::good);
    EXPECT_EQ(link->newest()->motors[1].torque_Nm, -2.0);
    device->reset();
    link->stop();
    EXPECT_EQ(link->sheet(0).firmware, std::string(version) + ".0");
    EXPECT_EQ(link->sheet(0).scales, "force gate 0.3, damping 0");
    EXPECT_FALSE(link->sheet(0).problem);
  }
}

TEST(Inverse3Link, BeforeItIsCalibratedThereIsNoForceAndThatIsSaid) {
  const auto server = serve({.calibrated = false});
  const auto link = link_to(server);
  ASSERT_FALSE(link->wait_until_asked(long_enough));
  auto device = MotorBusDevice::make(*link, {.joints = Joints<MotorJoint>(3, wide()), .late_s = 0.5, .silence_s = 2.0});
  ASSERT_TRUE(device);
  const Joints<station::DeviceCommand> push(3, {.force_N = 1.0, .enabled = true});
  EXPECT_TRUE(tick_until(**device, push, [&](const auto&) { return (*device)->health() == DeviceHealth::lost; }));
  EXPECT_EQ(link->newest()->motors[0].fault, MotorFault::encoder);
  EXPECT_EQ(link->newest()->motors[0].position_rad, 0.0);
  link->stop();
  EXPECT_EQ(link->sheet(0).problem->message,
            "device 049D is not calibrated and gives no force: put its handle where Haply Hub shows it");
}

TEST(Inverse3Link, AnswersThatAreLateMakeItDegradedThenSilent) {
  const auto server = serve({.late_ns = 150'000'000});
  const auto link = link_to(server);
  ASSERT_FALSE(link->wait_until_asked(long_enough));
  for (const double silence_s : {10.0, 0.1}) {
    auto device =
        MotorBusDevice::make(*link, {.joints = Joints<MotorJoint>(3, wide()), .late_s = 0.05, .silence_s = silence_s});
    ASSERT_TRUE(device);
    const DeviceHealth expected = silence_s > 1.0 ? DeviceHealth::degraded : DeviceHealth::not_responding;
    EXPECT_TRUE(tick_until(**device, no_power, [&](const auto&) { return (*device)->health() == expected; }));
  }
}

TEST(Inverse3Link, AConnectionThatEndsIsMadeAnewAndGivesNoForceByItself) {
  const auto server = serve({.closes_after = 200});
  const auto link = link_to(server);
  ASSERT_FALSE(link->wait_until_asked(long_enough));
  auto device =
      MotorBusDevice::make(*link, {.joints = Joints<MotorJoint>(3, wide()), .late_s = 0.02, .silence_s = 0.06});
  ASSERT_TRUE(device);
  ASSERT_TRUE(tick_until(**device, no_power, [&](const auto&) { return (*device)->health() == DeviceHealth::good; }));
  const Joints<station::DeviceCommand> push(3, {.force_N = 0.1, .enabled = true});
  ASSERT_TRUE(
      tick_until(**device, push, [&](const auto&) { return (*device)->health() == DeviceHealth::not_responding; }));
  const std::int64_t cycles = link->newest()->cycles;
  // It is there again, and stays silent while power is asked for.
  EXPECT_TRUE(tick_until(**device, push, [&](const auto&) { return link->newest()->cycles > cycles + 20; }));
  EXPECT_EQ((*device)->health(), DeviceHealth::not_responding);
  EXPECT_TRUE(tick_until(**device, no_power, [&](const auto&) { return (*device)->health() == DeviceHealth::good; }));
}

TEST(Inverse3Link, AnswersThatAreNoneAreLeftOut) {
  const auto server = serve({.garbage = 0.3, .seed = 7});
  const auto link = link_to(server);
  ASSERT_FALSE(link->wait_until_asked(long_enough));
  auto device = MotorBusDevice::make(*link, {.joints = Joints<MotorJoint>(3, wide()), .late_s = 0.5, .silence_s = 2.0});
  ASSERT_TRUE(device);
  const Joints<station::DeviceCommand> push(3, {.force_N = 1.0, .enabled = true});
  EXPECT_TRUE(tick_until(**device, push, [](const auto& reading) { return reading[2].position_m > 0.02; }));
  EXPECT_EQ((*device)->health(), DeviceHealth::good);
}

TEST(Inverse3Link, CommandsThatStopEndTheForce) {
  const auto server = serve({});
  const auto link = link_to(server);
  ASSERT_FALSE(link->wait_until_asked(long_enough));
  BusCommands push{.motors = {}, .time_ns = wire::monotonic_ns()};
  push.motors[0] = {.torque_Nm = 0.1, .enabled = 1};
  link->command(push);
  const auto powered = [&link] { return link->newest()->motors[0].enabled != 0; };
  for (int tries = 0; !powered() && tries < 500; ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(powered());
  for (int tries = 0; powered() && tries < 5000; ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(powered());
  EXPECT_TRUE(link->running());
}

/// A link whose first axis has been given a force.
std::unique_ptr<Inverse3Link> pushed(const Inverse3Server& server) {
  auto link = link_to(server);
  EXPECT_FALSE(link->wait_until_asked(long_enough));
  BusCommands push{.motors = {}, .time_ns = wire::monotonic_ns()};
  push.motors[0] = {.torque_Nm = 0.1, .enabled = 1};
  link->command(push);
  for (int tries = 0; link->newest()->motors[0].torque_Nm == 0.0 && tries < 5000; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(link->newest()->motors[0].torque_Nm, 0.1);
  EXPECT_EQ(link->newest()->motors[0].off, 0);
  return link;
}

TEST(Inverse3Link, ADeviceSaysThatItIsIdleBeforeTheLinkEnds) {
  for (const auto& [dialect, version] : enumerators(emulation::inverse3::Dialect{})) {
    const auto server = serve({.dialect = dialect});
    const auto link = pushed(server);
    link->stop();
    EXPECT_TRUE(link->powered_motors().empty()) << version;
  }
}

TEST(Inverse3Link, AForceThatDoesNotEndOrAModeThatIsNotKnownIsToldAtTheEnd) {
  struct Case {
    Inverse3Service::Params service;
    const char* told;
  };
  // The first ends its force for want of messages at the earliest after ten seconds.
  const Case keeps{{.silence_ns = 10'000'000'000, .keeps_force = true}, "mode 'force'"};
  for (const Case& each : {keeps, Case{{.mode = "spinning"}, "mode 'spinnin'"}}) {
    const auto server = serve(each.service);
    const auto link = pushed(server);
    BusCommands none{.motors = {}, .time_ns = wire::monotonic_ns()};
    link->command(none);
    for (int tries = 0; link->newest()->motors[0].fault != MotorFault::stays_on && tries < 5000; ++tries) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(link->newest()->motors[0].fault, MotorFault::stays_on);
    link->stop();
    const auto powered = link->powered_motors();
    ASSERT_EQ(powered.size(), 3U);
    EXPECT_EQ(status_text(powered[0].status), each.told);
  }
}

TEST(Inverse3Link, AForceThatEndsOnlyForWantOfMessagesEndsSo) {
  const auto server = serve({.keeps_force = true});  // 20 ms without a message end it
  const auto link = pushed(server);
  const BusCommands none{.motors = {}, .time_ns = wire::monotonic_ns()};
  link->command(none);
  for (int tries = 0; link->newest()->motors[0].torque_Nm != 0.0 && tries < 5000; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(link->newest()->motors[0].torque_Nm, 0.0);
  link->stop();
  ASSERT_FALSE(link->powered_motors().empty()) << "late is told too";
  EXPECT_EQ(link->newest()->motors[0].fault, MotorFault::stays_on);
}

TEST(Inverse3Link, ADeviceThatIsIdleUnderCommandsOfForceHasAFault) {
  const auto server = serve({.mode = "idle"});
  const auto link = link_to(server);
  ASSERT_FALSE(link->wait_until_asked(long_enough));
  BusCommands push{.motors = {}, .time_ns = 0};
  push.motors[0] = {.torque_Nm = 0.1, .enabled = 1};
  link->command(push);
  for (int tries = 0; link->newest()->motors[0].fault == MotorFault::none && tries < 5000; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(link->newest()->motors[0].fault, MotorFault::refused);
  EXPECT_EQ(status_text(link->newest()->motors[0].status), "mode 'idle'");
}

TEST(Inverse3Link, AServiceThatIsNotThereOrHasNoSuchDeviceIsToldWithTheRemedy) {
  std::uint16_t port = 0;
  {
    const auto server = serve({});
    port = server.port();
    const auto other =
        Inverse3Link::start({.address = "127.0.0.1:" + std::to_string(port), .device = "BEEF", .axes = {1, 2, 3}});
    ASSERT_TRUE(other);
    const Check unknown = (*other)->wait_until_asked(long_enough);
    ASSERT_TRUE(unknown);
    EXPECT_EQ(unknown->message, "the service has no 'BEEF' but 049D: state one of them");
  }
  const auto nobody = Inverse3Link::start({.address = "127.0.0.1:" + std::to_string(port), .device = {}, .axes = {1}});
  ASSERT_TRUE(nobody);
  const Check refused = (*nobody)->wait_until_asked(long_enough);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->message.find("no service answers there ("), 0U) << refused->message;
  const auto problem = [](std::string address, std::vector<std::int64_t> axes) {
    const auto link = Inverse3Link::start({.address = std::move(address), .device = {}, .axes = std::move(axes)});
    return link ? std::string() : describe(link.error());
  };
  EXPECT_EQ(problem("127.0.0.1", {1}), "port: '127.0.0.1' is no address: write HOST:PORT, as 127.0.0.1:10001");
  EXPECT_EQ(problem("a:1", {}), "motors: 0 axes: an Inverse3 has 1 to 3, x, y and z");
  EXPECT_EQ(problem("a:1", {2, 2}), "motors[1].id: another joint has this axis: 1 is x, 2 is y, 3 is z");
  EXPECT_NE(problem("a:1", {4}).find("motors[0].id: 4 is out of bounds"), std::string::npos) << problem("a:1", {4});
}

}  // namespace link_test
}  // namespace tactus::devices::inverse3
