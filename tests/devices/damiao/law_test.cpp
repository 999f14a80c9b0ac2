// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/damiao_bus.hpp>
#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/devices/motor_joint.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/wire/join.hpp>
#include <tactus/kernel/station/device_guard.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>
#include <tests/devices/dynamixel/bench.hpp>

/// The law that a motor runs by itself: from a joint's command to what an emulated motor does, which reads its bytes as
/// the maker's page says.
namespace tactus::devices::damiao {
namespace law_test {

using emulation::damiao::DamiaoPeer;
using emulation::damiao::JointParams;

constexpr std::int64_t ms = 1'000'000;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
/// Steps of a DM4310's frame: position, velocity, torque, gains.
constexpr double step_rad = 25.0 / 65535.0, step_rad_per_s = 60.0 / 4095.0, step_Nm = 20.0 / 4095.0,
                 step_Nm_per_rad = 500.0 / 4095.0;
/// What does not move, so that it shows the torque alone.
constexpr JointParams fixed{.inertia_kgm2 = 1e6, .damping_Nms_per_rad = 0.0, .friction_Nm = 0.0};
constexpr JointParams free_joint{.inertia_kgm2 = 0.02, .damping_Nms_per_rad = 0.0, .friction_Nm = 0.0};

/// One motor behind its bus, in virtual time.
struct OneMotor {
  explicit OneMotor(const JointParams& joint) {
    bus = *DamiaoBus::make({.framing = Framing::socketcan_fd, .motors = {{.id = 1, .feedback_id = 0x11}}});
    peer = *DamiaoPeer::make({.adapter = emulation::damiao::AdapterType::socketcan_fd,
                              .motors = {{.id = 1, .feedback_id = 0x11, .joint = joint}},
                              .faults = {}});
    run(100 * ms);
    EXPECT_EQ(bus->state(), BusState::ready);
  }
  void run(std::int64_t duration_ns) {
    wire::join(*bus, *peer, now_ns, now_ns + duration_ns);
    now_ns += duration_ns;
  }
  void command(const MotorCommand& wanted, std::int64_t duration_ns) {
    bus->command(0, wanted);
    run(duration_ns);
  }
  [[nodiscard]] const emulation::damiao::Motor& motor() const { return peer->motor(0); }

  std::unique_ptr<DamiaoBus> bus;
  std::unique_ptr<DamiaoPeer> peer;
  std::int64_t now_ns = 0;
};

TEST(MotorLaw, HoldsTheMotorWhereItIsToldAgainstATorque) {
  OneMotor one({.inertia_kgm2 = 0.02, .damping_Nms_per_rad = 0.02, .friction_Nm = 0.0});
  const MotorLaw law{.position_rad = 0.3, .stiffness_Nm_per_rad = 20.0, .damping_Nms_per_rad = 0.5};
  one.command({.torque_Nm = 1.0, .enabled = 1, .law = law}, 1000 * ms);
  // A gain is cut to the next code below, and so is the rest.
  EXPECT_NEAR(one.motor().position_rad(), 0.3 + 1.0 / 20.0,
              1.0 / 20.0 * step_Nm_per_rad / 20.0 + 2.0 * step_rad + 0.001);
  EXPECT_LT(std::fabs(one.motor().velocity_rad_per_s()), 1e-3);
}

TEST(MotorLaw, ItsDampingHasNoDelayOfTheBus) {
  OneMotor one({.inertia_kgm2 = 0.002, .damping_Nms_per_rad = 0.0, .friction_Nm = 0.0, .velocity_rad_per_s = 5.0});
  // Over a bus of some 2 kHz this gain would make 0.002 kg m² swing: the product with two cycles is beyond it.
  const MotorLaw law{.damping_Nms_per_rad = 4.0};
  one.command({.torque_Nm = 0.0, .enabled = 1, .law = law}, 20 * ms);
  EXPECT_LT(std::fabs(one.motor().velocity_rad_per_s()), 2.0 * step_rad_per_s);
}

TEST(MotorLaw, SwingsWithThePeriodOfItsStiffness) {
  OneMotor one(free_joint);
  one.command({.torque_Nm = 0.0, .enabled = 1}, 20 * ms);
  one.bus->command(0, {.torque_Nm = 0.0, .enabled = 1, .law = {.position_rad = 0.2, .stiffness_Nm_per_rad = 20.0}});
  const double period_s = 2.0 * std::numbers::pi * std::sqrt(0.02 / 20.0);
  double farthest_rad = 0.0;
  std::int64_t at_ns = 0;
  const std::int64_t began_ns = one.now_ns;
  while (one.now_ns < began_ns + std::llround(period_s * 1e9)) {
    one.run(ms);
    if (one.motor().position_rad() <= farthest_rad) continue;
    farthest_rad = one.motor().position_rad();
    at_ns = one.now_ns - began_ns;
  }
  EXPECT_NEAR(farthest_rad, 0.4, 0.01);
  EXPECT_NEAR(1e-9 * static_cast<double>(at_ns), 0.5 * period_s, 0.003);
}

TEST(MotorLaw, WithoutPowerNothingIsSent) {
  OneMotor one(free_joint);
  one.command({.torque_Nm = 1.0,
               .enabled = 0,
               .law = {.position_rad = 1.0, .stiffness_Nm_per_rad = 20.0, .damping_Nms_per_rad = 1.0}},
              50 * ms);
  EXPECT_FALSE(one.motor().enabled());
  EXPECT_EQ(one.motor().most_torque_Nm(), 0.0);
  EXPECT_EQ(one.motor().least_torque_Nm(), 0.0);
}

TEST(MotorLaw, WhatIsBeyondAFrameIsCutInOneShareAndNothingGrows) {
  struct Case {
    double torque_Nm, stiffness_Nm_per_rad, aim_rad, share;
  };
  // Torque and law against each other, as where a stiff law is weakened over the bus.
  for (const Case& c : {Case{-5.0, 1000.0, 0.01, 0.5}, Case{-16.0, 400.0, 0.05, 10.0 / 16.0},
                        Case{20.0, 2000.0, -0.006, 0.25}, Case{3.0, 100.0, 0.02, 1.0}}) {
    OneMotor one(fixed);
    one.command({.torque_Nm = c.torque_Nm,
                 .enabled = 1,
                 .law = {.position_rad = c.aim_rad, .stiffness_Nm_per_rad = c.stiffness_Nm_per_rad}},
                50 * ms);
    const double wanted_Nm = c.torque_Nm + c.stiffness_Nm_per_rad * c.aim_rad;
    const double lost_Nm =
        step_Nm + c.share * c.stiffness_Nm_per_rad * step_rad + step_Nm_per_rad * std::fabs(c.aim_rad);
    EXPECT_NEAR(one.motor().torque_Nm(), c.share * wanted_Nm, lost_Nm) << c.torque_Nm;
    EXPECT_LE(std::fabs(one.motor().torque_Nm()), std::fabs(wanted_Nm) + lost_Nm);
  }
}

TEST(MotorLaw, ANumberThatIsNoneOrANegativeGainTakesThePower) {
  const MotorLaw good{.position_rad = 0.1, .stiffness_Nm_per_rad = 10.0, .damping_Nms_per_rad = 1.0};
  for (const auto& [member, value] :
       {std::pair{&MotorLaw::position_rad, nan}, std::pair{&MotorLaw::velocity_rad_per_s, nan},
        std::pair{&MotorLaw::stiffness_Nm_per_rad, nan}, std::pair{&MotorLaw::damping_Nms_per_rad, nan},
        std::pair{&MotorLaw::stiffness_Nm_per_rad, -1.0}, std::pair{&MotorLaw::damping_Nms_per_rad, -0.1}}) {
    OneMotor one(fixed);
    one.command({.torque_Nm = 0.0, .enabled = 1, .law = good}, 20 * ms);
    ASSERT_TRUE(one.motor().enabled());
    MotorLaw bad = good;
    bad.*member = value;
    one.command({.torque_Nm = 0.0, .enabled = 1, .law = bad}, 20 * ms);
    EXPECT_FALSE(one.motor().enabled());
    EXPECT_LE(one.motor().most_torque_Nm(), 10.0 * 0.1 + 0.01);
  }
}

/// Its number begins anew at 12.5 rad, and the law's goes on.
TEST(MotorLaw, GoesOnBeyondTheTurnsOfTheNumber) {
  OneMotor one({.inertia_kgm2 = 0.02, .damping_Nms_per_rad = 0.0, .friction_Nm = 0.0, .velocity_rad_per_s = 8.0});
  while (one.bus->reading(0).position_rad < 15.0) one.run(ms);
  one.command({.torque_Nm = 0.0,
               .enabled = 1,
               .law = {.position_rad = 16.0, .stiffness_Nm_per_rad = 20.0, .damping_Nms_per_rad = 1.0}},
              1500 * ms);
  EXPECT_NEAR(one.motor().position_rad(), 16.0, 0.01);
  EXPECT_NEAR(one.bus->reading(0).position_rad, 16.0, 0.01);
}

TEST(MotorLaw, NearTheEndOfItsNumberAMotorHoldsNoPosition) {
  OneMotor one({.inertia_kgm2 = 0.02, .damping_Nms_per_rad = 0.0, .friction_Nm = 0.0, .position_rad = 11.5});
  const MotorLaw law{.position_rad = 12.8, .stiffness_Nm_per_rad = 5.0, .damping_Nms_per_rad = 0.4};
  one.command({.torque_Nm = 0.0, .enabled = 1, .law = law}, 3000 * ms);
  EXPECT_FALSE(one.motor().enabled());
  EXPECT_EQ(one.bus->reading(0).fault, MotorFault::encoder);
  EXPECT_GE(one.motor().least_torque_Nm(), -2.5) << "never the way round, which would be 25 rad";
  // Damping alone knows no position.
  OneMotor other({.inertia_kgm2 = 0.02, .damping_Nms_per_rad = 0.0, .friction_Nm = 0.0, .position_rad = 12.4});
  other.command({.torque_Nm = 0.0, .enabled = 1, .law = {.damping_Nms_per_rad = 1.0}}, 50 * ms);
  EXPECT_TRUE(other.motor().enabled());
}

MotorJoint turned() {
  MotorJoint joint;
  joint.sign = -1;
  joint.gear = 2.0;
  joint.offset_rad = 0.4;
  joint.lower_rad = -1.5;
  joint.upper_rad = 1.5;
  joint.torque_limit_Nm = 5.0;
  joint.stiffness_limit_Nm_per_rad = 40.0;
  joint.damping_limit_Nms_per_rad = 2.0;
  return joint;
}

station::DeviceReading told_by(const MotorJoint& joint, const MotorReading& motor) {
  return {.position_m = joint.position_rad(motor.position_rad),
          .motor_report = {.velocity_m_per_s = joint.velocity_rad_per_s(motor.velocity_rad_per_s),
                           .force_N = joint.torque_Nm(motor.torque_Nm)}};
}

TEST(MotorLaw, OfAJointStandsInTheJointsSignGearAndOffset) {
  const MotorJoint joint = turned();
  OneMotor one({.inertia_kgm2 = 0.02, .damping_Nms_per_rad = 0.02, .friction_Nm = 0.0});
  MotorCommand command = joint.motor_command(
      {.force_N = 1.0, .law = {.position_m = 0.6, .stiffness_N_per_m = 20.0, .damping_N_s_per_m = 2.0}},
      told_by(joint, one.bus->reading(0)), 0.0);
  command.enabled = 1;
  one.command(command, 1500 * ms);
  // At the joint 1 N m bends 20 N m/rad by 0.05 rad, whatever stands between it and the motor.
  EXPECT_NEAR(joint.position_rad(one.motor().position_rad()), 0.6 + 0.05, 0.002);
  const station::DeviceReading told = told_by(joint, one.bus->reading(0));
  EXPECT_NEAR(told.position_m, 0.65, 0.002);
  EXPECT_NEAR(told.motor_report.force_N, 0.0, 2.0 * 2.0 * step_Nm + 20.0 * step_rad);
  EXPECT_DOUBLE_EQ(joint.torque_Nm(1.0), -2.0);
  // Whole turns that the number does not count belong to the joint.
  EXPECT_NEAR(joint.motor_law({.position_m = 1.4}, 1.0).position_rad, 0.0, 1e-12);
}

TEST(MotorLaw, TorqueAndLawTogetherStayWithinTheJointsLimit) {
  const MotorJoint joint = turned();
  const station::DeviceReading at{.position_m = 0.1, .motor_report = {.velocity_m_per_s = 0.5}};
  const control::DriveLaw law{
      .position_m = 0.6, .velocity_m_per_s = 0.0, .stiffness_N_per_m = 40.0, .damping_N_s_per_m = 2.0};
  const auto given_Nm = [&](double force_N) {
    const MotorCommand motor = joint.motor_command({.force_N = force_N, .law = law}, at, 0.0);
    const double p = -2.0 * (at.position_m - joint.offset_rad), v = -2.0 * at.motor_report.velocity_m_per_s;
    return -2.0 * (motor.torque_Nm + motor.law.stiffness_Nm_per_rad * (motor.law.position_rad - p) +
                   motor.law.damping_Nms_per_rad * (motor.law.velocity_rad_per_s - v));
  };
  // The law alone wants 40 · 0.5 − 2 · 0.5 = 19 N m.
  EXPECT_NEAR(given_Nm(-16.0), 3.0, 1e-12) << "a force beyond the limit may stand against a law";
  EXPECT_NEAR(given_Nm(0.0), 5.0, 1e-12);
  EXPECT_NEAR(given_Nm(10.0), 5.0, 1e-12);
  EXPECT_NEAR(given_Nm(-30.0), -5.0, 1e-12);
  EXPECT_FALSE(joint.motor_command({.force_N = -30.0, .law = law}, at, 0.0).law.acts() &&
               joint.motor_command({.force_N = -30.0, .law = law}, at, 0.0).law.stiffness_Nm_per_rad > 10.0);
}

/// A link without a bus: what a tick wanted, and what somebody says that motors told.
class FakeLink final : public MotorLink {
 public:
  [[nodiscard]] std::size_t motors() const noexcept override { return 2; }
  void command(const BusCommands& commands) noexcept override { wanted = commands; }
  [[nodiscard]] std::optional<BusReadings> newest() const noexcept override { return told; }
  [[nodiscard]] bool running() const noexcept override { return true; }
  void stop() override {}
  Check wait_until_asked(Seconds) override { return std::nullopt; }
  [[nodiscard]] MotorSheet sheet(std::size_t) const override { return {}; }
  [[nodiscard]] std::vector<PoweredMotor> powered_motors() const override { return {}; }

  BusCommands wanted;
  BusReadings told;
};

struct DeviceOnALink {
  FakeLink link;
  std::unique_ptr<MotorBusDevice> device;
  explicit DeviceOnALink(const MotorJoint& joint) {
    for (std::size_t i = 0; i < 2; ++i) {
      link.told.motors[i] = {.position_rad = 0.2,
                             .velocity_rad_per_s = 1.0,
                             .torque_Nm = 0.5,
                             .enabled = 1,
                             .received_ns = ms,
                             .answers = 1};
    }
    link.told.state = BusState::ready;
    link.told.time_ns = ms;
    device = *MotorBusDevice::make(link, {.joints = Joints<MotorJoint>(2, joint)});
  }
  static station::Tick tick(std::int64_t number) {
    return {.number = number, .deadline_ns = ms * (number + 1), .began_ns = ms * (number + 1)};
  }
};

TEST(MotorLaw, ADeviceTellsItsMotorsAndStatesTheGainsThatItTakes) {
  DeviceOnALink one(turned());
  const auto told = one.device->read(DeviceOnALink::tick(0));
  EXPECT_DOUBLE_EQ(told[1].position_m, -0.1 + 0.4);
  EXPECT_DOUBLE_EQ(told[1].motor_report.velocity_m_per_s, -0.5);
  EXPECT_DOUBLE_EQ(told[1].motor_report.force_N, -1.0);
  EXPECT_EQ(told[1].force_N, 0.0);
  EXPECT_EQ(one.device->limits()[0].stiffness_N_per_m, 40.0);
  EXPECT_EQ(one.device->limits()[0].damping_N_s_per_m, 2.0);
  const Joints<station::DeviceCommand> command(
      2, {.force_N = 0.5, .law = {.position_m = 0.4, .stiffness_N_per_m = 8.0, .damping_N_s_per_m = 1.0}});
  const std::uint64_t before = laws::own_allocation_count();
  one.device->write(command);
  EXPECT_EQ(laws::own_allocation_count(), before);
  const MotorCommand& wanted = one.link.wanted.motors[0];
  EXPECT_DOUBLE_EQ(wanted.torque_Nm, -0.25);
  EXPECT_DOUBLE_EQ(wanted.law.position_rad, 0.0);
  EXPECT_DOUBLE_EQ(wanted.law.stiffness_Nm_per_rad, 2.0);
  EXPECT_DOUBLE_EQ(wanted.law.damping_Nms_per_rad, 0.25);
}

/// The wall before a device takes what its file allows and no more, and lets go of who insists.
TEST(MotorLaw, AJointThatMayRunNoneGetsNoneAndTheWallLetsGoOfWhoInsists) {
  MotorJoint joint = turned();
  joint.stiffness_limit_Nm_per_rad = joint.damping_limit_Nms_per_rad = 0.0;
  joint.velocity_limit_rad_per_s = 10.0;
  joint.torque_rate_limit_Nm_per_s = 1e4;
  DeviceOnALink one(joint);
  station::GuardedJointDevice guarded(*one.device);
  const Joints<station::DeviceCommand> command(2,
                                               {.force_N = 0.5, .law = {.position_m = 0.4, .damping_N_s_per_m = 1.0}});
  for (std::int64_t number = 0; number < 60; ++number) {
    guarded.read(DeviceOnALink::tick(number));
    guarded.write(command);
    EXPECT_FALSE(one.link.wanted.motors[0].law.acts());
  }
  EXPECT_EQ(guarded.cause(), station::ReleaseCause::force);
  EXPECT_EQ(one.link.wanted.motors[0].enabled, 0);
}

TEST(MotorLaw, AServoThatRunsNoneHasNoPowerWhileItIsAskedForOne) {
  dynamixel::bus_test::Rig rig({.servos = 2});
  rig.run(500 * ms);
  const auto enabled = [&rig] { return rig.bus.reading(0).enabled != 0; };
  rig.bus.command(0, {.torque_Nm = 0.05, .enabled = 1});
  rig.run(500 * ms);
  ASSERT_TRUE(enabled());
  rig.bus.command(0, {.torque_Nm = 0.05, .enabled = 1, .law = {.damping_Nms_per_rad = 0.1}});
  rig.run(500 * ms);
  EXPECT_FALSE(enabled());
}

}  // namespace law_test
}  // namespace tactus::devices::damiao
