// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/urdf/urdf.hpp>
#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/arm_control/arm_sites.hpp>
#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/control/support_law.hpp>
#include <tactus/kernel/station/site_pair.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <cstdint>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <tests/arm_control/arming_run.hpp>

/// Two simulated arms that are armed by sites whose model of them may be wrong, in virtual time. The arms are MuJoCo's
/// and stay as they are; what is wrong is the model alone, or how joints and motors are connected.
namespace tactus::arm_control {
namespace arming_test {

using control::SiteState;

inline constexpr std::size_t joints = 7;
inline constexpr double tick_s = 2e-3, plant_step_s = 2e-4;

/// The arm as it is: with the friction of its URDF and the steps in which its drives report.
inline const arm_plants::ArmPlant::Params& true_arm() {
  static const arm_plants::ArmPlant::Params arm = [] {
    const auto read = urdf::read(std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/openarm-class.urdf");
    EXPECT_TRUE(read) << describe(read.error());
    constexpr double armature_kg_m2[] = {0.0167, 0.0167, 0.029, 0.029, 0.0018, 0.0018, 0.0018};
    arm_plants::ArmPlant::Params params{.chain = read->params,
                                        .motors = Joints<arm_plants::MotorParams>(joints),
                                        .tool_m = arm::Vector3(0.0, 0.0, 0.15),
                                        .step_s = plant_step_s};
    for (std::size_t i = 0; i < joints; ++i) {
      params.chain.joints[i].drive.armature_kg_m2 = armature_kg_m2[i];
      params.motors[i] = {.position_step_rad = 0.0003815,
                          .velocity_step_rad_per_s = i < 2   ? 0.02198
                                                     : i < 4 ? 0.004884
                                                             : 0.01465};
    }
    return params;
  }();
  return arm;
}
inline arm::JointVector start() {
  arm::JointVector at(static_cast<Eigen::Index>(joints));
  at << 0.2, -1.771, 0.15, 1.4, 0.2, 0.1, 0.2;
  return at;
}

/// Limits, gates, probes and gains as in examples/rigs/openarm-arms.toml and examples/rigs/arms.toml.
struct JointRig {
  double torque_N_m, probe_N_m, leader_damping, follower_stiffness, follower_damping, damping_limit;
};
inline constexpr JointRig rig[joints] = {{15.0, 1.5, 5.0, 144.0, 3.0, 5.0}, {15.0, 1.5, 3.0, 144.0, 3.0, 5.0},
                                         {9.0, 1.5, 5.0, 144.0, 3.0, 5.0},  {9.0, 1.5, 5.0, 144.0, 3.0, 5.0},
                                         {3.0, 0.15, 0.2, 14.4, 0.2, 1.0},  {3.0, 0.4, 1.0, 18.6, 0.2, 1.0},
                                         {3.0, 0.5, 1.0, 15.0, 0.2, 1.0}};

inline Joints<control::SafetyGate::Params> gates() {
  control::SafetyGate::Params each;
  each.rate_limit_N_per_s = 400.0;
  each.velocity_limit_m_per_s = 5.6;
  each.position_limit_m = 2.4;
  each.encoder = {.fastest_m_per_s = 40.0, .frozen_force_N = 8.0, .frozen_after_s = 0.5};
  each.energy = {
      .damp_above_J = 30.0, .hold_above_J = 60.0, .credit_J = 20.0, .drain_W = 15.0, .damping_N_s_per_m = 0.5};
  Joints<control::SafetyGate::Params> all(joints, each);
  for (std::size_t i = 0; i < joints; ++i) all[i].force_limit_N = rig[i].torque_N_m;
  return all;
}

/// `raise_s` of 0 is without any judgement.
inline Joints<control::SupervisionParams> supervision(bool leads, double raise_s) {
  control::SupervisionParams each;
  each.longest_stall_s = 0.1;
  each.answer_within_s = 10.0;
  each.blend_s = 0.5;
  each.silence.catch_up_m_per_s = 0.3;
  each.watchdog.timeout_s = 0.1;
  each.packets.position_limit_m = 10.0;
  each.probe = {.duration_s = 0.4, .least_m = 0.0015, .most_m = 0.3};
  each.overload.missed_share = 0.5;
  each.force_sensor.residual_limit_N = each.hand_sensor.residual_limit_N = 200.0;
  Joints<control::SupervisionParams> all(joints, each);
  const arm::JointVector inertia = arm::Chain::make(true_arm().chain)->mass_matrix(start()).diagonal();
  for (std::size_t i = 0; i < joints; ++i) {
    all[i].probe.force_N = rig[i].probe_N_m;
    if (raise_s == 0.0) continue;
    all[i].support =
        control::with_holding_law({.raise_s = raise_s, .weight_limit_N = rig[i].torque_N_m},
                                  {.own_damping_N_s_per_m = leads ? rig[i].leader_damping : rig[i].follower_damping,
                                   .damping_limit_N_s_per_m = rig[i].damping_limit,
                                   .force_limit_N = rig[i].torque_N_m,
                                   .trial_force_N = rig[i].probe_N_m},
                                  Seconds{tick_s});
    all[i].probe = control::with_gentle_trial(all[i].probe, all[i].support, inertia[static_cast<Eigen::Index>(i)]);
  }
  return all;
}

/// The sites of two arms that they take for `believed`.
inline station::JointSupervisedPair sites_of(const arm::Chain::Params& believed, double raise_s) {
  arm_control::ArmLeader::Params leads{
      .method = arm_control::ArmMethod::cancellation, .force_gain = 0.5, .damping_N_s_per_m = 25.0};
  leads.drive_damping_limit_N_s_per_m = 20.0;
  leads.feed_forward.friction_share = 0.3;
  leads.model.hand = {.mass_kg = 0.4, .stiffness_N_per_m = 400.0, .damping_N_s_per_m = 30.0, .lever_m = 0.05};
  arm_control::ArmFollower::Params follows{.tool_stiffness_limit_N_per_m = 400.0, .tool_damping_limit_N_s_per_m = 8.0};
  follows.feed_forward.friction_share = 0.0;
  follows.observer.cutoff_Hz = 30.0;
  follows.observer.dead_band_share = 1.0;
  std::size_t joint = 0;
  for_each_field<arm_control::EachJoint<arm_control::DriveDamping>>([&](const auto& each) {
    if (joint < joints) (leads.drive_damping.*each.member).damping_N_m_s_per_rad = rig[joint++].leader_damping;
  });
  joint = 0;
  for_each_field<arm_control::EachJoint<arm_control::DriveGains>>([&](const auto& each) {
    if (joint == joints) return;
    follows.gains.*each.member = {.stiffness_N_m_per_rad = rig[joint].follower_stiffness,
                                  .damping_N_m_s_per_rad = rig[joint].follower_damping};
    ++joint;
  });
  const arm::Vector3 tool_m = true_arm().tool_m;
  auto leader = arm_control::leader_site(leads,
                                         {.carried = believed,
                                          .induced = {.chain = true_arm().chain, .tool_m = tool_m},
                                          .gains = follows.gains.of(joints)},
                                         gates(), Seconds{tick_s});
  EXPECT_TRUE(leader) << describe(leader.error());
  auto follower = arm_control::follower_site(follows, {.chain = believed, .tool_m = tool_m}, gates(), Seconds{tick_s});
  EXPECT_TRUE(follower) << describe(follower.error());
  auto master = control::supervise_master(*std::move(leader), supervision(true, raise_s), 1, Seconds{tick_s});
  EXPECT_TRUE(master) << describe(master.error());
  auto slave = control::supervise_slave(*std::move(follower), supervision(false, raise_s), 2, Seconds{tick_s});
  EXPECT_TRUE(slave) << describe(slave.error());
  return *station::JointSupervisedPair::around(*std::move(master), *std::move(slave), {}, Seconds{tick_s},
                                               Joints<double>(joints, 0.0));
}

/// Arms both by a model `believed` of each. A hand that holds an arm releases it after 4.2 s.
inline arming::Arming arm_both(const arm::Chain::Params& believed, arming::Before before,
                               const arming::Wiring& wiring = {}, double raise_s = 4.0) {
  constexpr double lets_go_s = 4.2, longest_s = 16.0;
  station::JointSupervisedPair sites = sites_of(believed, raise_s);
  static const arm::JointVector hangs = arming::hangs_at(true_arm());
  const arm::JointVector at = before == arming::Before::hangs ? hangs : start();
  const Joints<station::DeviceLimits> limits(joints);
  arming::ArmingDevice leader(true_arm(), at, before, wiring, limits), follower(true_arm(), at, before, wiring, limits);
  return arming::arm_both(sites, leader, follower, tick_s, lets_go_s, longest_s);
}

}  // namespace arming_test
}  // namespace tactus::arm_control
