// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/urdf/urdf.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>
#include <tactus/simulation/real_time/emulated_arm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <gtest/gtest.h>

/// Emulated motors that move an arm together. Frames are written and read here by the protocol page alone.
namespace tactus::real_time {
namespace emulated_arm_test {

using emulation::damiao::AdapterType;
using emulation::damiao::DamiaoPeer;
using emulation::damiao::MotorType;
using emulation::damiao::PeerSettings;

constexpr std::int64_t ms = 1'000'000;
constexpr std::uint32_t joints = 7;

arm::Chain::Params chain() {
  const auto read = urdf::read(std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/openarm-class.urdf");
  EXPECT_TRUE(read) << describe(read.error());
  arm::Chain::Params params = read->params;
  constexpr std::array armature_kg_m2{0.0167, 0.0167, 0.029, 0.029, 0.0018, 0.0018, 0.0018};
  for (std::size_t i = 0; i < joints; ++i) params.joints[i].drive.armature_kg_m2 = armature_kg_m2[i];
  return params;
}

arm::JointVector bent() {
  arm::JointVector q(7);
  q << 0.2, -1.771, 0.15, 1.4, 0.2, 0.1, 0.2;
  return q;
}

/// The motors of an arm on a bus of Linux, spoken to in frames of it.
struct Bus {
  explicit Bus(std::optional<arm::JointVector> held_at, std::uint32_t motors = joints,
               std::optional<EmulatedArm::Led> led = {}) {
    PeerSettings settings{.adapter = AdapterType::socketcan, .motors = {}, .faults = {}};
    for (std::uint32_t id = 1; id <= motors; ++id) {
      settings.motors.push_back({.id = id, .feedback_id = id + 0x10, .type = MotorType::dm8009});
    }
    auto made = EmulatedArm::make({.chain = chain(), .held_at = std::move(held_at), .led = led});
    EXPECT_TRUE(made) << describe(made.error());
    arm = made->get();
    peer = *DamiaoPeer::make(settings, *std::move(made));
    peer->say(now_ns);
  }
  /// A struct can_frame, and what the bus says to it.
  void send(std::uint32_t id, const std::array<std::uint8_t, 8>& data) {
    std::array<std::uint8_t, 16> frame{};
    frame[0] = static_cast<std::uint8_t>(id);
    frame[1] = static_cast<std::uint8_t>(id >> 8);
    frame[4] = 8;
    std::copy(data.begin(), data.end(), frame.begin() + 8);
    peer->hear(frame, now_ns);
    run(ms / 2);
  }
  void order_all(std::uint8_t what) {
    for (std::uint32_t id = 1; id <= joints; ++id) send(id, {255, 255, 255, 255, 255, 255, 255, what});
  }
  void run(std::int64_t duration_ns) {
    const std::int64_t until_ns = now_ns + duration_ns;
    while (now_ns < until_ns) {
      now_ns = std::min(until_ns, now_ns + ms);
      while (!peer->say(now_ns).empty()) {
      }
    }
  }
  /// MIT: torque alone, of a DM8009 (54 N m).
  void torque(std::uint32_t motor, double torque_Nm) {
    const auto t = static_cast<std::uint32_t>((torque_Nm + 54.0) / 108.0 * 4095.0);
    send(motor, {0x7f, 0xff, 0x7f, 0xf0, 0, 0, static_cast<std::uint8_t>(t >> 8), static_cast<std::uint8_t>(t)});
  }
  /// MIT: a stiffness of 60 N m/rad and 2 N m s/rad about where it is.
  void hold(std::uint32_t motor) {
    const double at_rad = peer->motor(motor - 1).position_rad();
    const auto p = static_cast<std::uint32_t>((at_rad + 12.5) / 25.0 * 65535.0);
    const auto kp = static_cast<std::uint32_t>(60.0 / 500.0 * 4095.0),
               kd = static_cast<std::uint32_t>(2.0 / 5.0 * 4095.0);
    const auto byte = [](std::uint32_t value) { return static_cast<std::uint8_t>(value & 0xff); };
    send(motor,
         {byte(p >> 8), byte(p), 0x7f, byte(0xf0 | kp >> 8), byte(kp), byte(kd >> 4), byte(kd << 4 | 0x7), 0xff});
  }
  [[nodiscard]] double moved_rad(const arm::JointVector& from) const {
    double most = 0.0;
    for (std::size_t i = 0; i < joints; ++i) {
      most = std::max(most, std::fabs(peer->motor(i).position_rad() - from[static_cast<Eigen::Index>(i)]));
    }
    return most;
  }
  [[nodiscard]] arm::JointVector positions() const {
    arm::JointVector q(7);
    for (std::size_t i = 0; i < joints; ++i) q[static_cast<Eigen::Index>(i)] = peer->motor(i).position_rad();
    return q;
  }

  EmulatedArm* arm = nullptr;
  std::unique_ptr<DamiaoPeer> peer;
  std::int64_t now_ns = 0;
};

TEST(EmulatedArm, HangsAtRestAndStaysThereWithoutPower) {
  Bus bus({});
  EXPECT_FALSE(bus.arm->held());
  const arm::JointVector hangs = bus.positions();
  bus.run(2000 * ms);
  EXPECT_LT(bus.moved_rad(hangs), 1e-3);
  // Where it hangs its weight asks for no more than friction of any joint.
  const arm::JointVector weight = arm::Chain::make(chain())->gravity_torque(hangs);
  for (std::size_t i = 0; i < joints; ++i) {
    EXPECT_LT(std::fabs(weight[static_cast<Eigen::Index>(i)]), chain().joints[i].friction.coulomb_N_m + 0.02) << i;
  }
}

TEST(EmulatedArm, IsHeldUntilItsMotorsCarryItAndThenFallsWithoutPower) {
  Bus bus(bent());
  bus.run(3000 * ms);
  EXPECT_TRUE(bus.arm->held());
  EXPECT_EQ(bus.moved_rad(bent()), 0.0);
  bus.send(0x7ff, {1, 0, 0x55, 9, 0, 0, 0, 0});
  for (std::uint8_t id = 2; id <= joints; ++id) bus.send(0x7ff, {id, 0, 0x55, 9, 0, 0, 0, 0});
  bus.order_all(0xfc);
  const arm::JointVector weight = arm::Chain::make(chain())->gravity_torque(bent());
  EXPECT_GT(weight.cwiseAbs().maxCoeff(), 1.0);
  for (std::uint32_t id = 1; id <= joints; ++id) {
    EXPECT_TRUE(bus.arm->held()) << id;
    bus.torque(id, weight[id - 1]);
  }
  bus.run(10 * ms);
  EXPECT_FALSE(bus.arm->held());
  bus.run(500 * ms);
  EXPECT_LT(bus.moved_rad(bent()), 1e-3) << "what carries it, carries it";
  bus.order_all(0xfd);
  bus.run(400 * ms);
  EXPECT_GT(bus.moved_rad(bent()), 0.2) << "nobody holds it any more";
}

TEST(EmulatedArm, AHandLeadsEveryJointBackAndForthOnceItsMotorsCarryItAndItsTimeHasCome) {
  constexpr double reach_rad = 0.2;
  Bus bus(bent(), joints, EmulatedArm::Led{.reach_rad = reach_rad, .after_s = 0.5});
  bus.run(1000 * ms);
  EXPECT_TRUE(bus.arm->held()) << "who is not carried is not led";
  bus.order_all(0xfc);
  const arm::JointVector weight = arm::Chain::make(chain())->gravity_torque(bent());
  for (std::uint32_t id = 1; id <= joints; ++id) bus.torque(id, weight[id - 1]);
  bus.run(400 * ms);
  EXPECT_FALSE(bus.arm->held());
  EXPECT_LT(bus.moved_rad(bent()), 1e-3) << "not yet";
  arm::JointVector least = bent(), most = bent();
  for (int i = 0; i < 700; ++i) {
    bus.run(10 * ms);
    const arm::JointVector at = bus.positions();
    least = least.cwiseMin(at);
    most = most.cwiseMax(at);
  }
  // The motors do not follow the weight and friction is in the way, so it comes less far, or farther, than it wants.
  for (Eigen::Index i = 0; i < 7; ++i) {
    EXPECT_GT(most[i] - least[i], reach_rad) << i;
    EXPECT_LT(most[i] - least[i], 4.0 * reach_rad) << i;
  }
}

/// The same torques make another instance of the plant move as the motors tell.
TEST(EmulatedArm, AHandTapsWithItAndItsToolMeetsASurfaceBetweenTheLifts) {
  auto made = EmulatedArm::make({.chain = chain(),
                                 .held_at = bent(),
                                 .tapping = EmulatedArm::Tapping{.depth_m = 0.04, .period_s = 1.5, .after_s = 0.5},
                                 .surface = EmulatedArm::Surface{.gap_m = 0.02},
                                 .tool_m = 0.15 * arm::Vector3::UnitZ()});
  ASSERT_TRUE(made) << describe(made.error());
  EmulatedArm& arm = **made;
  const auto model = *arm::Chain::make(chain());
  const arm::Vector3 began_m = arm.tool().position_m;
  int touches = 0;
  bool touched = false;
  double most_N = 0.0, lowest_m = 0.0, highest_m = -1.0;
  constexpr int steps = 75'000;  // of 100 µs: three taps from 2.5 s on
  for (int step = 0; step < steps; ++step) {
    arm::JointVector q(7), v(7);
    for (std::size_t i = 0; i < joints; ++i) {
      q[static_cast<Eigen::Index>(i)] = arm.position_rad(i);
      v[static_cast<Eigen::Index>(i)] = arm.velocity_rad_per_s(i);
    }
    // Motors that carry it and damp it, by a model that is not the plant's.
    const arm::JointVector torque = model.gravity_torque(q) - 0.3 * v;
    arm.step(std::span(torque.data(), joints));
    const double below_m = (arm.tool().position_m - began_m).z();
    if (step < 24'000) {
      EXPECT_EQ(arm.contact_N(), 0.0) << "nobody taps yet";
    }
    const bool now = arm.contact_N() > 0.5;
    touches += now && !touched ? 1 : 0;
    touched = now || (touched && below_m < -0.015);  // what bounces at the surface touches once
    most_N = std::max(most_N, arm.contact_N());
    if (step < 25'000) continue;
    lowest_m = std::min(lowest_m, below_m);
    highest_m = std::max(highest_m, below_m);
  }
  EXPECT_EQ(touches, 4) << "at 2.5, 4, 5.5 and 7 s";
  EXPECT_GT(most_N, 2.0);
  EXPECT_LT(lowest_m, -0.0195);
  EXPECT_GT(lowest_m, -0.022) << "it is stiff";
  EXPECT_GT(highest_m, -0.01) << "and it lifts off again";
}

TEST(EmulatedArm, MovesAsItsPlantDoesUnderTheTorquesOfTheMotors) {
  Bus bus({});
  bus.order_all(0xfc);
  const arm::JointVector began = bus.positions();
  auto plant =
      *arm_plants::ArmPlant::make({.chain = chain(), .motors = Joints<arm_plants::MotorParams>(joints)}, began);
  const double before_rad = bus.peer->motor(1).position_rad();
  bus.torque(2, 3.0);
  bus.run(200 * ms);
  const double moved_rad = bus.peer->motor(1).position_rad() - before_rad;
  EXPECT_GT(std::fabs(moved_rad), 0.01);
  arm::JointVector torque = arm::JointVector::Zero(7);
  torque[1] = bus.peer->motor(1).torque_Nm();
  EXPECT_NEAR(torque[1], 3.0, 108.0 / 4095.0);
  plant.write(arm::ArmCommand::of_torque(torque));
  for (int i = 0; i < 2000; ++i) plant.step({});
  // The command arrived within the half millisecond after it was sent.
  EXPECT_NEAR(plant.link_position()[1] - began[1], moved_rad, 0.02 * std::fabs(moved_rad) + 1e-3);
  // A link pulls the others along.
  EXPECT_GT((plant.link_position() - began).cwiseAbs().minCoeff() + bus.moved_rad(began), 0.01);
}

TEST(EmulatedArm, ItsMotorsHoldItByTheirOwnLaw) {
  Bus bus(bent());
  bus.order_all(0xfc);
  for (std::uint32_t id = 1; id <= joints; ++id) bus.hold(id);
  // The law gives nothing where it holds, so the hand lets go of nothing: it must be carried first.
  EXPECT_TRUE(bus.arm->held());
  Bus hanging({});
  hanging.order_all(0xfc);
  const arm::JointVector at = hanging.positions();
  for (std::uint32_t id = 1; id <= joints; ++id) hanging.hold(id);
  hanging.run(300 * ms);
  EXPECT_LT(hanging.moved_rad(at), 0.02);
}

TEST(EmulatedArm, AMotorBeyondItsJointsTurnsAJointOfItsOwnAndAZeroStaysOne) {
  Bus bus({}, 8);
  const double own_rad = bus.peer->motor(7).position_rad();
  bus.send(8, {255, 255, 255, 255, 255, 255, 255, 0xfc});
  const arm::JointVector at = bus.positions();
  bus.torque(8, 2.0);
  bus.run(100 * ms);
  EXPECT_GT(bus.peer->motor(7).position_rad(), own_rad + 0.1);
  EXPECT_LT(bus.moved_rad(at), 1e-3);
  bus.send(2, {255, 255, 255, 255, 255, 255, 255, 0xfe});
  EXPECT_NEAR(bus.peer->motor(1).position_rad(), 0.0, 1e-3);
  bus.run(100 * ms);
  EXPECT_NEAR(bus.peer->motor(1).position_rad(), 0.0, 1e-3);
}

TEST(EmulatedArm, FewerMotorsThanJointsAreRefused) {
  PeerSettings settings{.motors = {{.id = 1, .feedback_id = 0x11}}, .faults = {}};
  const auto made = DamiaoPeer::make(settings, *EmulatedArm::make({.chain = chain()}));
  ASSERT_FALSE(made);
  EXPECT_EQ(describe(made.error()), "motors: 1 motors for an arm of 7 joints: each joint has one");
}

}  // namespace emulated_arm_test
}  // namespace tactus::real_time
