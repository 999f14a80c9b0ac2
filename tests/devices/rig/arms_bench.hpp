// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/hardware/devices/damiao/damiao_bus.hpp>
#include <tactus/hardware/devices/rig/rig_arms.hpp>
#include <tactus/hardware/devices/rig/rig_loop.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/wire/join.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>
#include <tactus/simulation/arm_plants/tool_operator.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/simulation/real_time/emulated_arm.hpp>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

/// Two arms with their weight behind emulated motors, in virtual time, driven as `tactus run` drives them.
namespace tactus::devices {
namespace rig_arms_test {

using arm_plants::ToolForce;
using arm_plants::ToolState;
using control::SiteState;
using emulation::damiao::DamiaoPeer;
using experiments::ArmPairSetup;
using real_time::EmulatedArm;

inline constexpr std::int64_t ms = 1'000'000, tick_ns = 2 * ms;
inline constexpr std::size_t joints = 7;
inline const std::string rigs = TACTUS_RIG_FOLDER;

using Faults = std::vector<emulation::damiao::Fault>;

inline ArmPairSetup setup_of(const std::vector<std::string>& more = {}) {
  auto document = configuration::Document::load(rigs + "/arms.toml");
  EXPECT_TRUE(document) << describe(document.error());
  for (const std::string& one : more) EXPECT_FALSE(document->set(one));
  const auto params = document->read<experiments::ArmTappingParams>();
  EXPECT_TRUE(params) << describe(params.error());
  const auto setup = experiments::set_up_arm_pair(*params, rigs);
  EXPECT_TRUE(setup) << describe(setup.error());
  return *setup;
}

inline RigPair pair_of() {
  const auto rig = Rig::load(rigs + "/openarm-arms.toml");
  EXPECT_TRUE(rig) << describe(rig.error());
  return rig->pairs()[0];
}

/// A bus and its emulated motors, driven in virtual time in place of a thread's.
class VirtualLink final : public MotorLink {
 public:
  VirtualLink(const RigSide& side, const EmulatedArm::Settings& settings, double gripper_rad, const Faults& faults) {
    using emulation::damiao::MotorType;
    damiao::DamiaoBusParams params{.framing = damiao::Framing::socketcan_fd, .watchdog_s = 0.05, .motors = {}};
    emulation::damiao::PeerSettings motors{
        .adapter = emulation::damiao::AdapterType::socketcan_fd, .motors = {}, .faults = faults};
    for (const StatedMotor& motor : side.bus.motors) {
      damiao::Model model{};
      MotorType type{};
      for (const auto& entry : enumerators(damiao::Model{})) {
        if (motor.model == entry.name) model = entry.value;
      }
      for (const auto& entry : enumerators(MotorType{})) {
        if (motor.model == entry.name) type = entry.value;
      }
      params.motors.push_back({.id = motor.id, .feedback_id = motor.id + 0x10, .model = model});
      const auto id = static_cast<std::uint32_t>(motor.id);
      motors.motors.push_back({.id = id, .feedback_id = id + 0x10, .type = type});
      if (id > joints) motors.motors.back().joint.position_rad = gripper_rad;
    }
    auto made = EmulatedArm::make(settings);
    EXPECT_TRUE(made) << describe(made.error());
    arm = made->get();
    bus = *damiao::DamiaoBus::make(params);
    peer = *DamiaoPeer::make(motors, *std::move(made));
  }
  void run_until(std::int64_t until_ns) {
    while (now_ns < until_ns) {
      const std::int64_t next_ns = std::min(until_ns, now_ns + ms / 2);
      const bool heard = watch.trusts(wanted, now_ns);
      for (std::size_t i = 0; i < bus->motors(); ++i) bus->command(i, heard ? wanted.motors[i] : MotorCommand{});
      if (!cut) {
        wire::join(*bus, *peer, now_ns, next_ns);
      } else {
        bus->say(next_ns);
        peer->say(next_ns);
      }
      now_ns = next_ns;
      if (bus->cycles() == told.cycles && bus->state() == told.state) continue;
      for (std::size_t i = 0; i < bus->motors(); ++i) told.motors[i] = bus->reading(i);
      told.state = bus->state();
      told.cycles = bus->cycles();
      told.time_ns = now_ns;
      told.unheard = heard ? 0 : 1;
    }
  }
  [[nodiscard]] std::size_t motors() const noexcept override { return bus->motors(); }
  void command(const BusCommands& commands) noexcept override { wanted = commands; }
  [[nodiscard]] std::optional<BusReadings> newest() const noexcept override { return told; }
  [[nodiscard]] bool running() const noexcept override { return true; }
  void stop() override {}
  Check wait_until_asked(Seconds) override { return std::nullopt; }
  [[nodiscard]] MotorSheet sheet(std::size_t motor) const override { return bus->sheet(motor); }
  [[nodiscard]] std::vector<PoweredMotor> powered_motors() const override { return {}; }

  EmulatedArm* arm = nullptr;
  std::unique_ptr<damiao::DamiaoBus> bus;
  std::unique_ptr<DamiaoPeer> peer;
  bool cut = false;  ///< nothing passes on the wire
  std::int64_t now_ns = 0;

 private:
  CommandWatch watch{50 * ms};  // as that of a bus's thread
  BusCommands wanted;
  BusReadings told{.motors = {}, .cycles = -1};
};

/// The pair. Hands and stands hold both arms until their motors carry them; then nobody does, but where a test says so.
struct Bench {
  Faults faults;  ///< of the follower
  ArmPairSetup setup;
  RigPair pair = *as_arms(pair_of(), setup.params, setup);
  double apart_rad = 0.15;                ///< of joint 4, leader and follower
  std::optional<arm::Vector3> hand_at_m;  ///< where a hand holds the leader's tool, on a spring
  std::optional<arm_plants::Wall> wall;   ///< in the follower's way
  ToolForce hand, contact;
  std::unique_ptr<VirtualLink> leader_link = link(*pair.leader, apart_rad, 0.2, {}, [this](const ToolState& tool) {
    constexpr double stiffness_N_per_m = 400.0, damping_N_s_per_m = 30.0;
    hand = {};
    if (hand_at_m) {
      hand.force_N = stiffness_N_per_m * (*hand_at_m - tool.position_m) - damping_N_s_per_m * tool.velocity_m_per_s;
    }
    return hand;
  });
  std::unique_ptr<VirtualLink> follower_link = link(*pair.follower, 0.0, 0.0, faults, [this](const ToolState& tool) {
    contact = wall ? ToolForce{.force_N = wall->force_N(tool)} : ToolForce{};
    return contact;
  });
  std::unique_ptr<MotorBusDevice> leader = device(*leader_link, *pair.leader);
  std::unique_ptr<MotorBusDevice> follower = device(*follower_link, *pair.follower);
  runtime::SiteExchange exchange;
  std::optional<RigLoop> loop;
  RigSecond last;
  std::int64_t number = 0;

  /// `believed` is what the sites take both arms for; without it they are right. `more` changes keys of the experiment.
  explicit Bench(Faults of_follower = {}, const std::optional<arm::Chain::Params>& believed = {},
                 const std::vector<std::string>& more = {})
      : faults(std::move(of_follower)), setup(setup_of(more)) {
    // Motors are asked before a tick is.
    advance(400 * ms);
    start({.listen_before_arming_s = 0.1, .arm_at_once = true}, believed);
  }
  void start(const RigLoop::Params& params, const std::optional<arm::Chain::Params>& believed = {}) {
    ArmPairSetup of_sites = setup;
    if (believed) of_sites.leader.arm.chain = of_sites.follower.arm.chain = *believed;
    auto sites = arm_sites(of_sites.params, of_sites, leader->limits(), follower->limits());
    EXPECT_TRUE(sites) << describe(sites.error());
    auto made = RigLoop::around(*std::move(sites), Seconds{1e-9 * tick_ns}, params, exchange, *leader, *follower);
    EXPECT_TRUE(made) << describe(made.error());
    loop.emplace(*std::move(made));
  }
  std::unique_ptr<VirtualLink> link(const RigSide& side, double off_rad, double gripper_rad, const Faults& of_it,
                                    std::function<ToolForce(const ToolState&)> touched) const {
    arm::JointVector at = setup.leader.start;
    at[3] += off_rad;
    return std::make_unique<VirtualLink>(side,
                                         EmulatedArm::Settings{.chain = setup.leader.arm.chain,
                                                               .held_at = at,
                                                               .tool_m = setup.leader.arm.tool_m,
                                                               .touched = std::move(touched)},
                                         gripper_rad, of_it);
  }
  static std::unique_ptr<MotorBusDevice> device(VirtualLink& link, const RigSide& side) {
    return *MotorBusDevice::make(link, {.joints = side.motor_joints(), .silence_s = 0.05});
  }
  void advance(std::int64_t duration_ns) {
    leader_link->run_until(leader_link->now_ns + duration_ns);
    follower_link->run_until(follower_link->now_ns + duration_ns);
  }
  void run(double duration_s) {
    for (std::int64_t i = 0; i < std::llround(duration_s * 1e9) / tick_ns; ++i) {
      const std::int64_t now_ns = leader_link->now_ns;
      (*loop)({.number = number++, .deadline_ns = now_ns, .began_ns = now_ns});
      while (const auto second = loop->next_second()) last = *second;
      advance(tick_ns);
    }
  }
  /// Until both follow; false where they do not.
  bool couple() {
    for (int seconds = 0; seconds < 20 && last.follower != SiteState::active; ++seconds) run(1.0);
    return last.follower == SiteState::active;
  }
  [[nodiscard]] static arm::JointVector positions(const VirtualLink& link) {
    arm::JointVector q(static_cast<Eigen::Index>(joints));
    for (std::size_t i = 0; i < joints; ++i) q[static_cast<Eigen::Index>(i)] = link.peer->motor(i).position_rad();
    return q;
  }
  [[nodiscard]] static arm::JointVector torques(const VirtualLink& link) {
    arm::JointVector torque(static_cast<Eigen::Index>(joints));
    for (std::size_t i = 0; i < joints; ++i) torque[static_cast<Eigen::Index>(i)] = link.peer->motor(i).torque_Nm();
    return torque;
  }
  [[nodiscard]] double apart() const {
    return (positions(*leader_link) - positions(*follower_link)).cwiseAbs().maxCoeff();
  }
  [[nodiscard]] static arm::Vector3 tool_m(const VirtualLink& link) { return link.arm->tool().position_m; }
};

}  // namespace rig_arms_test
}  // namespace tactus::devices
