// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/bus_thread.hpp>
#include <tactus/hardware/devices/damiao/damiao_bus.hpp>
#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/wire/paced.hpp>
#include <tactus/hardware/wire/talk.hpp>

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>

namespace tactus::devices {
namespace bus_thread_test {

using emulation::damiao::DamiaoPeer;
using emulation::damiao::FaultKind;
using station::DeviceHealth;

/// Emulated motors at a pseudo-terminal, at the real clock.
class Motors {
 public:
  explicit Motors(std::vector<emulation::damiao::Fault> faults = {})
      : peer_(make(std::move(faults))),
        line_(*peer_, wire::byte_ns(921'600), wire::Paced::Line::full_duplex),
        port_(*wire::Port::pseudo_terminal()),
        thread_([this] { wire::talk(line_, *port_, [this] { return stopping_.load(); }); }) {}
  ~Motors() { fall_silent(); }

  [[nodiscard]] std::string path() const { return path_; }
  void fall_silent() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }
  void unplug() {
    fall_silent();
    port_.reset();
  }
  /// Once it fell silent.
  [[nodiscard]] const DamiaoPeer& peer() const { return *peer_; }

 private:
  static std::unique_ptr<DamiaoPeer> make(std::vector<emulation::damiao::Fault> faults) {
    emulation::damiao::PeerSettings settings;
    settings.motors = {{.id = 1, .feedback_id = 0x11}, {.id = 2, .feedback_id = 0x12}};
    settings.faults = std::move(faults);
    return *DamiaoPeer::make(settings);
  }

  std::unique_ptr<DamiaoPeer> peer_;
  wire::Paced line_;
  std::optional<wire::Port> port_;
  std::string path_ = port_->path();
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// With timeout for a machine that does other things too.
std::unique_ptr<BusThread> bus_at(const Motors& motors, double silence_s = 5.0) {
  damiao::DamiaoBusParams params;
  params.watchdog_s = 1.0;
  params.reply_timeout_s = 0.05;
  params.motors = {{.id = 1, .feedback_id = 0x11}, {.id = 2, .feedback_id = 0x12}};
  auto port = wire::Port::serial(motors.path(), 921'600);
  EXPECT_TRUE(port.ok());
  auto thread = BusThread::start(*damiao::DamiaoBus::make(params), *std::move(port), {.silence_s = silence_s});
  EXPECT_TRUE(thread.ok());
  return *std::move(thread);
}

std::unique_ptr<MotorBusDevice> device_of(BusThread& bus) {
  MotorJoint joint;
  joint.lower_rad = -1000.0;
  joint.upper_rad = 1000.0;
  joint.velocity_limit_rad_per_s = 100.0;
  joint.torque_limit_Nm = 10.0;
  auto device =
      MotorBusDevice::make(bus, {.joints = Joints<MotorJoint>(bus.motors(), joint), .late_s = 0.5, .silence_s = 2.0});
  EXPECT_TRUE(device.ok());
  return *std::move(device);
}

station::Tick tick_now() {
  static std::int64_t number = 0;
  const std::int64_t now_ns = wire::monotonic_ns();
  return {.number = ++number, .deadline_ns = now_ns, .began_ns = now_ns};
}

constexpr Seconds long_enough{20.0};

/// Ticks until it is so. False where it never is.
bool tick_until(MotorBusDevice& device, double torque_Nm, bool enabled, const std::function<bool()>& holds) {
  const std::int64_t until_ns = wire::monotonic_ns() + std::int64_t{20'000'000'000};
  const Joints<station::DeviceCommand> command(2, {.force_N = torque_Nm, .enabled = enabled});
  do {
    device.read(tick_now());
    if (holds()) return true;
    device.write(command);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  } while (wire::monotonic_ns() < until_ns);
  return false;
}

/// A trigger turns half as far as the gripper that it is coupled with: gear 0.5. Motor and joint give the same power.
TEST(BusThread, AGripperHasAScaleAndAForceLimitOfItsOwn) {
  Motors motors;
  auto bus = bus_at(motors);
  ASSERT_FALSE(bus->wait_until_asked(long_enough));
  MotorJoint elbow;
  elbow.lower_rad = -1000.0;
  elbow.upper_rad = 1000.0;
  elbow.velocity_limit_rad_per_s = 1000.0;
  elbow.torque_limit_Nm = 10.0;
  MotorJoint gripper = elbow;
  gripper.gear = 0.5;
  gripper.torque_limit_Nm = 0.1;
  Joints<MotorJoint> joints(2, elbow);
  joints[1] = gripper;
  auto device = *MotorBusDevice::make(*bus, {.joints = joints, .late_s = 0.5, .silence_s = 2.0});
  Joints<station::DeviceReading> reading;
  ASSERT_TRUE(tick_until(*device, 0.4, true, [&] {
    reading = device->read(tick_now());
    return reading[1].position_m > 0.5;
  }));
  const BusReadings told = *bus->newest();
  device.reset();
  bus.reset();
  motors.fall_silent();
  // What the gripper is told to do ends at its own limit, and its motor turns half as far with twice the torque.
  constexpr double lsb_Nm = 20.0 / 4095.0;
  EXPECT_NEAR(motors.peer().motor(0).most_torque_Nm(), 0.4, lsb_Nm);
  EXPECT_NEAR(motors.peer().motor(1).most_torque_Nm(), 0.1 / 0.5, lsb_Nm);
  EXPECT_NEAR(gripper.position_rad(told.motors[1].position_rad), 2.0 * told.motors[1].position_rad, 1e-12);
  EXPECT_GT(motors.peer().motor(1).position_rad(), 0.25 - 0.001);
  EXPECT_GT(told.motors[1].position_rad, 0.25 - 0.001);
}

TEST(BusThread, MotorsBecomeADeviceAndLoseTheirPowerWhenItEnds) {
  Motors motors;
  auto bus = bus_at(motors);
  const Check wrong = bus->wait_until_asked(long_enough);
  ASSERT_FALSE(wrong) << describe(*wrong);
  auto device = device_of(*bus);
  EXPECT_TRUE(tick_until(*device, 0.0, false, [&] { return device->health() == DeviceHealth::good; }));
  Joints<station::DeviceReading> reading(2);
  EXPECT_TRUE(tick_until(*device, 0.5, true, [&] {
    reading = device->read(tick_now());
    return reading[0].position_m > 0.1 && reading[1].position_m > 0.1;
  }));
  EXPECT_EQ(device->health(), DeviceHealth::good);
  bus->stop();
  EXPECT_TRUE(bus->powered_motors().empty());
  motors.fall_silent();
  for (const std::size_t motor : {0U, 1U}) {
    EXPECT_FALSE(motors.peer().motor(motor).enabled());
    EXPECT_NEAR(motors.peer().motor(motor).most_torque_Nm(), 0.5, 0.01);
  }
}

TEST(BusThread, AServoTickNeverWaitsNorAllocates) {
  Motors motors;
  auto bus = bus_at(motors);
  ASSERT_FALSE(bus->wait_until_asked(long_enough));
  auto device = device_of(*bus);
  const Joints<station::DeviceCommand> command(2, {.force_N = 0.1, .enabled = true});
  const std::uint64_t before = laws::own_allocation_count();
  std::int64_t fastest_ns = 1'000'000'000;
  for (int tick = 0; tick < 1000; ++tick) {
    const std::int64_t start_ns = wire::monotonic_ns();
    device->read(tick_now());
    device->write(command);
    fastest_ns = std::min(fastest_ns, wire::monotonic_ns() - start_ns);
  }
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_LT(fastest_ns, 100'000);
}

TEST(BusThread, CommandsThatStopTakeThePowerAndDoNotGiveItBackByThemselves) {
  Motors motors;
  auto bus = bus_at(motors, 1.0);
  ASSERT_FALSE(bus->wait_until_asked(long_enough));
  auto device = device_of(*bus);
  const auto all_on = [&] {
    const auto now = bus->newest();
    return now && now->motors[0].enabled != 0 && now->motors[1].enabled != 0;
  };
  const auto all_off = [&] {
    const auto now = bus->newest();
    return now && now->motors[0].enabled == 0 && now->motors[1].enabled == 0;
  };
  ASSERT_TRUE(tick_until(*device, 0.0, false, [&] { return device->health() == DeviceHealth::good; }));
  ASSERT_TRUE(tick_until(*device, 0.1, true, all_on));
  const std::int64_t until_ns = wire::monotonic_ns() + std::int64_t{20'000'000'000};
  while (!all_off() && wire::monotonic_ns() < until_ns) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(all_off());
  const std::int64_t cycles = bus->newest()->cycles;
  EXPECT_TRUE(tick_until(*device, 0.1, true, [&] { return bus->newest()->cycles > cycles + 50; }));
  EXPECT_TRUE(all_off());
  EXPECT_EQ(device->health(), DeviceHealth::not_responding);
  EXPECT_EQ(device->trouble().fault, MotorFault::lost_master);
  EXPECT_TRUE(tick_until(*device, 0.0, false, [&] {
    return device->health() == DeviceHealth::good && bus->newest()->cycles > cycles + 100;
  }));
  EXPECT_TRUE(tick_until(*device, 0.1, true, all_on));
}

TEST(BusThread, ABusThatFallsSilentIsDegradedThenSilent) {
  Motors motors;
  auto bus = bus_at(motors);
  ASSERT_FALSE(bus->wait_until_asked(long_enough));
  auto device = device_of(*bus);
  ASSERT_TRUE(tick_until(*device, 0.0, false, [&] { return device->health() == DeviceHealth::good; }));
  motors.fall_silent();
  EXPECT_TRUE(tick_until(*device, 0.0, false, [&] { return device->health() == DeviceHealth::degraded; }));
  EXPECT_EQ(device->trouble().what, Trouble::late);
  EXPECT_TRUE(tick_until(*device, 0.0, false, [&] { return device->health() == DeviceHealth::not_responding; }));
  EXPECT_EQ(device->trouble().what, Trouble::not_responding);
  EXPECT_GT(device->trouble().age_s, 2.0);
}

TEST(BusThread, AMotorWithAFaultUnderPowerIsLost) {
  Motors motors({{.kind = FaultKind::hot_drive, .motor = 2, .from_ns = 1'500'000'000}});
  auto bus = bus_at(motors);
  ASSERT_FALSE(bus->wait_until_asked(long_enough));
  auto device = device_of(*bus);
  ASSERT_TRUE(tick_until(*device, 0.0, false, [&] { return device->health() == DeviceHealth::good; }));
  EXPECT_TRUE(tick_until(*device, 0.1, true, [&] { return device->health() == DeviceHealth::lost; }));
  EXPECT_EQ(bus->newest()->motors[1].fault, MotorFault::hot);
  EXPECT_EQ(device->trouble().what, Trouble::motor_fault);
  EXPECT_EQ(device->trouble().joint, 1U);
  EXPECT_EQ(device->trouble().fault, MotorFault::hot);
}

TEST(BusThread, AStatusThatIsNotKnownUnderPowerIsLostAndTheMotorIsOffAndToldAtTheEnd) {
  Motors motors({{.kind = FaultKind::status, .motor = 2, .from_ns = 1'500'000'000, .status = 0x7}});
  auto bus = bus_at(motors);
  ASSERT_FALSE(bus->wait_until_asked(long_enough));
  auto device = device_of(*bus);
  ASSERT_TRUE(tick_until(*device, 0.0, false, [&] { return device->health() == DeviceHealth::good; }));
  EXPECT_TRUE(tick_until(*device, 0.1, true, [&] { return device->health() == DeviceHealth::lost; }));
  EXPECT_EQ(device->trouble().what, Trouble::motor_fault);
  EXPECT_EQ(device->trouble().joint, 1U);
  EXPECT_EQ(device->trouble().fault, MotorFault::unknown_status);
  EXPECT_EQ(device->trouble().status, 0x7);
  // Released, and after a while it is a motor that does not switch off, so nobody can arm.
  EXPECT_TRUE(tick_until(*device, 0.0, false, [&] { return device->trouble().fault == MotorFault::stays_on; }));
  EXPECT_EQ(device->health(), DeviceHealth::lost);
  bus->stop();
  const auto powered = bus->powered_motors();
  ASSERT_EQ(powered.size(), 1U);
  EXPECT_EQ(powered[0].motor, 1U);
  EXPECT_EQ(powered[0].status, 0x7);
  EXPECT_FALSE(powered[0].off);
  motors.fall_silent();
  for (const std::size_t motor : {0U, 1U}) EXPECT_FALSE(motors.peer().motor(motor).enabled());
}

TEST(BusThread, AMotorThatIgnoresDisableIsToldWhenTheBusIsStoppedAtOnce) {
  Motors motors({{.kind = FaultKind::ignores_disable, .motor = 1}});
  auto bus = bus_at(motors);
  ASSERT_FALSE(bus->wait_until_asked(long_enough));
  auto device = device_of(*bus);
  ASSERT_TRUE(tick_until(*device, 0.1, true, [&] {
    const auto now = bus->newest();
    return now && now->motors[0].enabled != 0 && now->motors[1].enabled != 0;
  }));
  device.reset();
  bus->stop();
  const auto powered = bus->powered_motors();
  ASSERT_EQ(powered.size(), 1U);
  EXPECT_EQ(powered[0].motor, 0U);
  EXPECT_EQ(powered[0].status, 0x1);
}

TEST(BusThread, APortThatIsUnpluggedEndsItAndTheDeviceIsLost) {
  Motors motors;
  auto bus = bus_at(motors);
  ASSERT_FALSE(bus->wait_until_asked(long_enough));
  auto device = device_of(*bus);
  motors.unplug();
  // The bus may end between a reading and what is asked after it: what the device says is what counts.
  EXPECT_TRUE(tick_until(*device, 0.0, false, [&] { return device->health() == DeviceHealth::lost; }));
  EXPECT_EQ(device->trouble().what, Trouble::bus_ended);
  EXPECT_FALSE(bus->running());
  const Check wrong = bus->wait_until_asked(long_enough);
  ASSERT_TRUE(wrong);
  EXPECT_EQ(describe(*wrong).find(motors.path() + ": the port was closed"), 0U) << describe(*wrong);
}

TEST(BusThread, MotorsThatAreNotWhatIsStatedAreToldWithThePort) {
  Motors motors({{.kind = FaultKind::wrong_scale, .motor = 1}});
  auto bus = bus_at(motors);
  const Check wrong = bus->wait_until_asked(long_enough);
  ASSERT_TRUE(wrong);
  EXPECT_EQ(describe(*wrong).find(motors.path() + ": motor 1 (DM4310): its register 22 (VMAX) reads 45"), 0U)
      << describe(*wrong);
}

}  // namespace bus_thread_test
}  // namespace tactus::devices
