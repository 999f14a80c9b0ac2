// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/joined_devices.hpp>
#include <tactus/kernel/station/local_teleoperator.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "carriage.hpp"
#include <gtest/gtest.h>

namespace tactus::station {
namespace joints_test {

using control::SiteRequests;
using control::SiteState;

/// A device of several carriages, which stay in snapshot.
struct Arm {
  std::vector<Carriage*> joints;
  std::unique_ptr<JoinedDevices> device;

  explicit Arm(std::size_t count, bool simulated = false) {
    std::vector<std::unique_ptr<Device>> owned;
    for (std::size_t i = 0; i < count; ++i) {
      auto carriage = std::make_unique<Carriage>(limits, simulated);
      joints.push_back(carriage.get());
      owned.push_back(std::move(carriage));
    }
    device = JoinedDevices::make(std::move(owned)).value();
  }
};

/// A hand and a wall at each joint, other ones at each.
void set_up(Carriage& master, Carriage& slave, std::size_t joint) {
  const auto number = static_cast<double>(joint);
  master.hand_N_per_m = 60.0 + 20.0 * number;
  slave.wall_N_per_m = 500.0 + 100.0 * number;
  slave.wall_m = 0.01 - 0.002 * number;
}
/// Where the hand of a joint is at a tick: into the wall and out of it, in the joint's own rhythm.
double hand_m(std::size_t joint, std::int64_t number) {
  const double time_s = static_cast<double>(number) * period.value;
  return 0.007 * (1.0 - std::cos((4.0 + static_cast<double>(joint)) * time_s));
}

control::ControlParams of_joint(std::size_t joint) {
  control::ControlParams control = chosen();
  control.supervision.probe.force_N = 0.0;
  control.force_gain = 0.5 + 0.25 * static_cast<double>(joint);
  control.gate.force_limit_N = 3.0 + static_cast<double>(joint);
  control.supervision.silence.catch_up_m_per_s = 0.05 + 0.01 * static_cast<double>(joint);
  return control;
}
Joints<control::ControlParams> of_joints(std::size_t count) {
  Joints<control::ControlParams> all(count);
  for (std::size_t joint = 0; joint < count; ++joint) all[joint] = of_joint(joint);
  return all;
}

/// Ways that delay, reorder and lose.
constexpr LinkParams lossy{.to_slave = {.delay_s = 0.002, .jitter_s = 0.001, .loss_fraction = 0.05, .seed = 3},
                           .to_master = {.delay_s = 0.002, .jitter_s = 0.001, .loss_fraction = 0.05, .seed = 4}};

bool same_bits(double one, double other) {
  return std::bit_cast<std::uint64_t>(one) == std::bit_cast<std::uint64_t>(other);
}

/// What the person presses: through all states, with a hold and what leads out of it.
SiteRequests pressed_at(std::int64_t number) {
  const std::int64_t at = number % 10'000;
  return {.align = at > 100 && at<200, .arm = at> 300 && at<400, .dead_man = at> 500 && at<9'000, .clutch = at> 6'000 &&
                   at < 6'500};
}

/// Runs three axes in one station and each by itself, and compares all that the motors get and all that the sites are.
template <class JointPair, class Pair, class RequestAt>
void compare_with_single_runs(std::int64_t ticks, const RequestAt& request_at) {
  constexpr std::size_t count = 3;
  Arm masters(count, true), slaves(count, true);
  auto together = DevicePair<JointPair>::make(of_joints(count), lossy, period, Joints<double>(count, 0.0),
                                              *masters.device, *slaves.device)
                      .value();
  std::vector<std::unique_ptr<Carriage>> lone_masters, lone_slaves;
  std::vector<DevicePair<Pair>> alone;
  for (std::size_t joint = 0; joint < count; ++joint) {
    lone_masters.push_back(std::make_unique<Carriage>(limits, true));
    lone_slaves.push_back(std::make_unique<Carriage>(limits, true));
    set_up(*masters.joints[joint], *slaves.joints[joint], joint);
    set_up(*lone_masters[joint], *lone_slaves[joint], joint);
    alone.push_back(
        DevicePair<Pair>::make(of_joint(joint), lossy, period, 0.0, *lone_masters[joint], *lone_slaves[joint]).value());
  }
  double largest_N = 0.0;
  for (std::int64_t number = 0; number < ticks; ++number) {
    const Tick now = tick(number, number % 977 == 976 ? 2 : 0);
    for (std::size_t joint = 0; joint < count; ++joint) {
      masters.joints[joint]->hand_m = lone_masters[joint]->hand_m = hand_m(joint, number);
    }
    together.step(now, request_at(number));
    for (std::size_t joint = 0; joint < count; ++joint) {
      alone[joint].step(now, request_at(number));
      for (const auto& [one, other] : {std::pair{masters.joints[joint], lone_masters[joint].get()},
                                       std::pair{slaves.joints[joint], lone_slaves[joint].get()}}) {
        ASSERT_TRUE(same_bits(one->command.force_N, other->command.force_N)) << "joint " << joint << " at " << number;
        ASSERT_TRUE(same_bits(one->position_m(), other->position_m())) << "joint " << joint << " at " << number;
        ASSERT_EQ(one->command.enabled, other->command.enabled) << "joint " << joint << " at " << number;
      }
      largest_N = std::fmax(largest_N, std::fabs(masters.joints[joint]->command.force_N));
    }
  }
  EXPECT_GT(largest_N, 0.5) << "nothing was felt";
}

TEST(SeveralJoints, ThreeAxesAreThreeSingleRunsBitForBit) {
  compare_with_single_runs<JointBarePair, BarePair>(20'000, [](std::int64_t) { return 1.0; });
}

TEST(SeveralJoints, UnderSupervisionTooThroughAllStates) {
  compare_with_single_runs<JointSupervisedPair, SupervisedPair>(20'000, pressed_at);
}

/// Several joints, each with a hand and a wall, and a person at both sites.
struct Bench {
  Arm master, slave;
  JointLocalTeleoperator loop;
  std::int64_t number = 0;

  explicit Bench(const Joints<control::ControlParams>& control)
      : master(control.size(), true),
        slave(control.size(), true),
        loop(JointLocalTeleoperator::make(control, {}, period, Joints<double>(control.size(), 0.0), *master.device,
                                          *slave.device)
                 .value()) {
    for (std::size_t joint = 0; joint < control.size(); ++joint) {
      set_up(*master.joints[joint], *slave.joints[joint], joint);
    }
  }
  void run(double duration_s, const SiteRequests& pressed) {
    for (const std::int64_t end = number + std::lround(duration_s / period.value); number < end; ++number) {
      loop.step(tick(number), pressed);
    }
  }
  void press_into_the_walls() {
    run(0.05, {});
    run(0.05, {.align = true});
    run(0.05, {.arm = true});
    run(0.3, {.dead_man = true});
    for (Carriage* joint : master.joints) joint->hand_m = 0.02;
    run(0.3, {.dead_man = true});
  }
  [[nodiscard]] bool both(SiteState state) const {
    return loop.sites().master().state() == state && loop.sites().slave().state() == state;
  }
};

TEST(SeveralJoints, AFaultOfOneLetsAllGoAndClearingItBringsAllBack) {
  Bench bench(of_joints(3));
  bench.press_into_the_walls();
  ASSERT_TRUE(bench.both(SiteState::active));
  for (const Carriage* joint : bench.slave.joints) ASSERT_GT(std::fabs(joint->command.force_N), 0.05);
  bench.slave.joints[1]->carry_to(std::nan(""));
  bench.run(0.1, {.dead_man = true});
  EXPECT_EQ(bench.loop.sites().slave().state(), SiteState::fault);
  for (const Carriage* joint : bench.slave.joints) {
    EXPECT_EQ(joint->command.force_N, 0.0);
    EXPECT_FALSE(joint->command.enabled);
  }
}

/// Without supervision nothing but the site itself lets the others go.
TEST(SeveralJoints, AFaultOfOneLetsAllGoWithoutSupervisionToo) {
  Arm master(3, true), slave(3, true);
  auto loop =
      JointBareTeleoperator::make(of_joints(3), {}, period, Joints<double>(3, 0.0), *master.device, *slave.device)
          .value();
  std::int64_t number = 0;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) loop.step(tick(number++), 1.0);
  };
  for (std::size_t joint = 0; joint < 3; ++joint) {
    set_up(*master.joints[joint], *slave.joints[joint], joint);
    master.joints[joint]->hand_m = 0.02;
  }
  run(2000);
  for (const Carriage* joint : slave.joints) ASSERT_GT(std::fabs(joint->command.force_N), 0.05);
  slave.joints[1]->carry_to(std::nan(""));
  run(500);
  for (const Carriage* joint : slave.joints) EXPECT_EQ(joint->command.force_N, 0.0);
  EXPECT_FALSE(loop.healthy());
}

TEST(SeveralJoints, AreOneToEight) {
  for (const std::size_t count : {0U, 9U}) {
    std::vector<std::unique_ptr<Device>> motors;
    for (std::size_t i = 0; i < count; ++i) motors.push_back(std::make_unique<Carriage>(limits));
    const auto made = JoinedDevices::make(std::move(motors));
    ASSERT_FALSE(made) << count;
    EXPECT_EQ(made.error().parameter, "joints");
  }
}

TEST(SeveralJoints, APacketOfAnotherNumberOfThemOrWithOneBadNumberIsRefused) {
  auto judge =
      control::PacketJudgeOf<Joints<control::Message>>::make(Joints<control::PacketJudgeParams>(3), period).value();
  control::JointPacket packet{.session = 5, .sequence = 1, .message = Joints<control::Message>(3)};
  EXPECT_EQ(judge.step(packet), control::PacketVerdict::applied);
  for (const std::size_t count : {0U, 2U, 4U}) {
    EXPECT_EQ(judge.step({.session = 5, .sequence = 2, .message = Joints<control::Message>(count)}),
              control::PacketVerdict::implausible)
        << count;
  }
  packet.sequence = 2;
  packet.message[2].force_N = std::nan("");
  EXPECT_EQ(judge.step(packet), control::PacketVerdict::not_finite);
  packet.message[2].force_N = 1e4;
  EXPECT_EQ(judge.step(packet), control::PacketVerdict::implausible);
  packet.message[2].force_N = 1.0;
  EXPECT_EQ(judge.step(packet), control::PacketVerdict::applied);
}

TEST(SeveralJoints, OneThatIsBeyondWhatItsDeviceAllowsHasTheWallLetAllGo) {
  Arm arm(3);
  GuardedJointDevice wall(*arm.device);
  const Joints<DeviceCommand> wanted(3, {.force_N = 0.1});
  std::int64_t number = 0;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      wall.read(tick(number++));
      wall.write(wanted);
    }
  };
  run(50);
  for (const Carriage* joint : arm.joints) EXPECT_EQ(joint->command.force_N, 0.1);
  arm.joints[2]->carry_to(0.06);
  run(5);
  EXPECT_EQ(wall.cause(), ReleaseCause::position);
  EXPECT_EQ(wall.health(), DeviceHealth::lost);
  for (const Carriage* joint : arm.joints) EXPECT_FALSE(joint->command.enabled);
}

TEST(SeveralJoints, MotorsAreTriedOneAfterTheOtherAndAllBeforeAnyFollows) {
  Joints<control::ControlParams> control(3, chosen());
  control[1].supervision.probe.force_N = 0.0;
  Bench bench(control);
  bench.run(0.05, {});
  bench.run(0.05, {.align = true});
  std::array<double, 3> peaks_N{};
  int together = 0;
  for (int i = 0; i < 3000 && bench.loop.sites().master().state() != SiteState::active; ++i) {
    bench.run(period.value, {.arm = i<250, .dead_man = i> 250});
    if (bench.loop.sites().master().state() == SiteState::active) break;
    int pushing = 0;
    for (std::size_t joint = 0; joint < 3; ++joint) {
      const double force_N = std::fabs(bench.master.joints[joint]->command.force_N);
      peaks_N[joint] = std::fmax(peaks_N[joint], force_N);
      pushing += force_N > 0.0 ? 1 : 0;
    }
    together += pushing > 1 ? 1 : 0;
  }
  EXPECT_TRUE(bench.both(SiteState::active));
  EXPECT_NEAR(peaks_N[0], 0.5, 0.01);
  EXPECT_EQ(peaks_N[1], 0.0) << "nobody asked for it";
  EXPECT_NEAR(peaks_N[2], 0.5, 0.01);
  EXPECT_EQ(together, 0);
}

TEST(SeveralJoints, WhatDoesNotFitIsRefusedByTheJointsName) {
  Arm master(3, true), slave(3, true);
  const auto refused_for = [&](const Joints<control::ControlParams>& control, Arm& at_slave) {
    const auto made = JointLocalTeleoperator::make(control, {}, period, Joints<double>(control.size(), 0.0),
                                                   *master.device, *at_slave.device);
    return made ? std::string("nothing") : made.error().parameter;
  };
  EXPECT_EQ(refused_for(of_joints(3), slave), "nothing");
  EXPECT_EQ(refused_for(of_joints(2), slave), "master");
  Arm two(2, true), real(3);
  EXPECT_EQ(refused_for(of_joints(3), two), "slave");
  Joints<control::ControlParams> control = of_joints(3);
  control[1].gate.force_limit_N = -1.0;
  EXPECT_EQ(refused_for(control, slave), "control.joint_2.gate.force_limit_N");
  control = of_joints(3);
  control[2].supervision.watchdog.timeout_s *= 2.0;
  EXPECT_EQ(refused_for(control, slave), "control.supervision.joint_3.watchdog.timeout_s");
  control = of_joints(3);
  for (auto& joint : control) joint.supervision.probe.force_N = 0.5;
  EXPECT_EQ(refused_for(control, real), "nothing");
  control[1].slave_gate = {};
  EXPECT_EQ(refused_for(control, real), "control.joint_2.slave_gate.force_limit_N");
  EXPECT_EQ(JointSupervisedPair::make(of_joints(3), {}, period, Joints<double>(2)).error().parameter, "slave_start_m");
  control = of_joints(3);
  for (auto& joint : control) {
    joint.supervision.probe.force_N = 0.5;
    joint.supervision.answer_within_s = 0.35;
  }
  EXPECT_EQ(refused_for(control, slave), "control.supervision.answer_within_s") << "three trials take 0.3 s";
}

}  // namespace joints_test
}  // namespace tactus::station
