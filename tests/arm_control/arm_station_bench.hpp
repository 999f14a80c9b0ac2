// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/arm_sites.hpp>
#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/station/site_pair.hpp>
#include <tactus/simulation/arm_plants/arm_device.hpp>
#include <tactus/simulation/arm_plants/tool_operator.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "tests/arm_plants/openarm.hpp"

/// Two arms of MuJoCo, supervised, by `station::step`, as a person on a machine has them.
namespace tactus::arm_control::arm_station_test {

using arm_plants::ArmDevice;
using arm_plants::ArmPlant;
using control::SiteRequests;
using control::SiteState;

constexpr Seconds tick{1e-3};
constexpr int steps_in_a_tick = 10;
constexpr std::size_t joints = 7;
constexpr arm::HandImpedance firm{
    .mass_kg = 0.4, .stiffness_N_per_m = 400.0, .damping_N_s_per_m = 30.0, .lever_m = 0.05};

/// Friction as the arm's data sheet has it: it keeps an arm that nobody carries from falling freely.
inline ArmPlant::Params arm_params() {
  ArmPlant::Params params = arm_plants::openarm_class();
  for (std::size_t i = 0; i < joints; ++i) {
    params.chain.joints[i].friction.coulomb_N_m = i < 4 ? 0.3 : 0.08;
    params.chain.joints[i].friction.viscous_N_m_s_per_rad = 0.06;
    params.motors[i].torque_limit_N_m = params.chain.joints[i].limits.effort_N_m;
  }
  return params;
}

inline Joints<control::SafetyGate::Params> gates() {
  Joints<control::SafetyGate::Params> gates(joints, widest_gate());
  for (std::size_t i = 0; i < joints; ++i) {
    gates[i].force_limit_N = arm_params().chain.joints[i].limits.effort_N_m;
    gates[i].rate_limit_N_per_s = 2000.0;
    gates[i].velocity_limit_m_per_s = 8.0;
    gates[i].position_limit_m = 3.1;
  }
  return gates;
}

/// Drives that tell no torque from outside: nothing for a check of it to compare with.
inline Joints<control::SupervisionParams> supervision() {
  control::SupervisionParams params;
  params.force_sensor.residual_limit_N = 200.0;
  return Joints<control::SupervisionParams>(joints, params);
}

inline ArmLeader::Params leader_params() {
  ArmLeader::Params params{.method = ArmMethod::cancellation, .force_gain = 1.0, .damping_N_s_per_m = 25.0};
  params.feed_forward.friction_share = 0.3;
  params.drive_damping_limit_N_s_per_m = 20.0;
  for_each_field<EachJoint<DriveDamping>>(
      [&](const auto& each) { (params.drive_damping.*each.member).damping_N_m_s_per_rad = 1.0; });
  params.drive_damping.joint_2.damping_N_m_s_per_rad = 3.0;
  params.model.hand = firm;
  return params;
}

inline ArmFollower::Params follower_params() {
  ArmFollower::Params params{.tool_stiffness_limit_N_per_m = 400.0, .tool_damping_limit_N_s_per_m = 8.0};
  for_each_field<EachJoint<DriveGains>>([&](const auto& each) {
    params.gains.*each.member = {.stiffness_N_m_per_rad = 140.0, .damping_N_m_s_per_rad = 3.0};
  });
  params.gains.joint_5 = params.gains.joint_6 =
      params.gains.joint_7 = {.stiffness_N_m_per_rad = 18.0, .damping_N_m_s_per_rad = 0.2};
  params.feed_forward.friction_share = 0.0;
  params.wanted_motion.cutoff_Hz = 6.0;
  params.observer.dead_band_share = 1.0;
  return params;
}

inline ArmLeader::Arm leader_arm() {
  return {.carried = arm_params().chain,
          .induced = {.chain = arm_params().chain, .tool_m = arm_params().tool_m},
          .gains = follower_params().gains.of(joints)};
}
inline ArmFollower::Arm follower_arm() { return {.chain = arm_params().chain, .tool_m = arm_params().tool_m}; }

inline Joints<double> start() {
  Joints<double> at(joints);
  for (std::size_t i = 0; i < joints; ++i) at[i] = arm_plants::bent()[static_cast<Eigen::Index>(i)];
  return at;
}

inline ArmDevice device(double carried_kg) {
  ArmPlant::Params params = arm_params();
  params.carried_kg = carried_kg;
  return {*ArmPlant::make(params, arm_plants::bent()), Joints<station::DeviceLimits>(joints)};
}

inline station::JointSupervisedPair supervised_pair(const PassivityParams& passivity = {}) {
  ArmLeader::Params leads = leader_params();
  leads.passivity = passivity;
  ArmFollower::Arm follows = follower_arm();
  follows.passivity = {.params = passivity, .gain = leads.force_gain};
  auto master = control::supervise_master(*leader_site(leads, leader_arm(), gates(), tick), supervision(), 1, tick);
  auto slave =
      control::supervise_slave(*follower_site(follower_params(), follows, gates(), tick), supervision(), 2, tick);
  return *station::JointSupervisedPair::around(*std::move(master), *std::move(slave), {}, tick, start());
}

/// A firm hand at the leader's tool and a stiff surface below the follower's, 10 mm away. Nobody presses anything yet.
struct Bench {
  ArmDevice leader = device(0.4), follower = device(0.0);
  arm_plants::ToolOperator person;
  station::JointSupervisedPair sites;
  station::JointSupervisedPair::Output last;
  arm::Vector3 began_m = follower.plant().tool().position_m;
  arm_plants::Wall wall{
      .point_m = began_m - 0.01 * arm::Vector3::UnitZ(),
      .normal = arm::Vector3::UnitZ(),
      .contact = *mechanics::Environment::make({.stiffness_N_per_m = 20000.0, .damping_N_s_per_m = 20.0}, tick)};
  double aim_m = 0.0;        ///< of the hand, along the wall's normal
  double contact_N = 0.0;    ///< now
  double most_step_N = 0.0;  ///< between two ticks, of any motor, as the gate counts it
  std::int64_t number = 0;
  bool held = true;

  explicit Bench(const PassivityParams& passivity = {})
      : person(*arm_plants::ToolOperator::make({.hand = firm}, tick, leader.plant().tool())),
        sites(supervised_pair(passivity)) {}

  void step(const SiteRequests& pressed, std::int64_t missed = 0) {
    number += missed;
    const auto passed = [this](std::size_t i) {
      return std::pair(sites.master().site().gates()[i].motor().passed_N(),
                       sites.slave().site().gates()[i].motor().passed_N());
    };
    std::array<std::pair<double, double>, joints> before;
    for (std::size_t i = 0; i < joints; ++i) before[i] = passed(i);
    last = sites.step(leader, follower, {.number = number++, .missed = missed}, pressed);
    for (std::size_t i = 0; i < joints; ++i) {
      most_step_N = std::fmax(most_step_N, std::fabs(passed(i).first - before[i].first));
      most_step_N = std::fmax(most_step_N, std::fabs(passed(i).second - before[i].second));
    }
    move();
  }
  void move() {
    const arm::Vector3 path = began_m + aim_m * arm::Vector3::UnitZ();
    person.begin_tick(path, path, leader.plant().tool());
    for (int i = 0; i < steps_in_a_tick; ++i) {
      leader.step(held ? person.force(leader.plant().tool(), i * 1e-4) : arm_plants::ToolForce{});
      const arm_plants::ToolForce contact{.force_N = wall.force_N(follower.plant().tool())};
      contact_N = std::fabs(contact.force_N.z());
      follower.step(contact);
    }
  }
  void run(double duration_s, const SiteRequests& pressed) {
    for (int i = 0; i < std::lround(duration_s / tick.value); ++i) step(pressed);
  }
  void couple() {
    run(0.05, {});
    run(0.2, {.align = true});
    run(0.05, {.arm = true});
    run(0.5, {.dead_man = true});
  }
  /// The hand goes 12 mm beyond the surface, in a second, and stays.
  void press_on_the_wall() {
    for (int i = 0; i < 1000; ++i) {
      aim_m = -0.022e-3 * i;
      step({.dead_man = true});
    }
    run(0.5, {.dead_man = true});
  }
  [[nodiscard]] bool both(SiteState state) const {
    return sites.master().state() == state && sites.slave().state() == state;
  }
  /// No torque of any motor, no law and no power.
  [[nodiscard]] static bool has_let_go(const auto& done) {
    for (const auto& joint : done.output.site) {
      if (joint.motor_force_N != 0.0 || joint.law.acts()) return false;
    }
    return !done.output.record.enabled;
  }
};

inline double fell_mm(const ArmDevice& arm, const arm::Vector3& from_m) {
  return 1e3 * (arm.plant().tool().position_m - from_m).norm();
}

}  // namespace tactus::arm_control::arm_station_test
