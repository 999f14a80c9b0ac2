// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/arm_stability/arm_margins.hpp>
#include <tactus/data/configuration/document.hpp>
#include <tactus/kernel/arm_control/arm_sites.hpp>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tactus::arm_stability {

inline const std::filesystem::path experiments_folder = TACTUS_EXPERIMENT_FOLDER;

/// An experiment of arms, with files and values on top.
inline experiments::ArmPairSetup setup_of(const std::vector<std::string>& on_top) {
  auto document = configuration::Document::load(experiments_folder / "arm-tapping.toml").value();
  for (const std::string& one : on_top) {
    const Check wrong = one.ends_with(".toml")
                            ? document.merge(configuration::Document::load(experiments_folder / "arms" / one).value())
                            : document.set(one);
    if (wrong) throw std::runtime_error(describe(*wrong));
  }
  const auto params = document.read<experiments::ArmTappingParams>();
  if (!params) throw std::runtime_error(describe(params.error()));
  return experiments::set_up_arm_pair(*params, experiments_folder).value();
}

/// The same without what a linear loop has not: Coulomb friction, steps, the dead band, the person's correction, and
/// the torque of the wanted motion, which contact that is felt takes away.
inline experiments::ArmPairSetup smooth(experiments::ArmPairSetup setup) {
  for (experiments::DescribedArm* one : {&setup.leader, &setup.follower}) {
    for (arm::JointParams& joint : one->arm.chain.joints) joint.friction.coulomb_N_m = 0.0;
    for (arm_plants::MotorParams& motor : one->arm.motors) {
      motor.position_step_rad = motor.velocity_step_rad_per_s = motor.torque_step_N_m = 0.0;
    }
  }
  setup.exact.induced.chain = setup.leader.arm.chain;
  setup.params.control.follower.observer.dead_band_share = 0.0;
  setup.params.control.follower.wanted_motion.cutoff_Hz = 0.0;
  setup.params.person.correction_gain_per_s = 0.0;
  return setup;
}

/// The pair of `experiments::ArmPair`, its follower's tool glued to the wall: it pulls as it pushes.
class GluedPair {
 public:
  static GluedPair make(const experiments::ArmPairSetup& setup, double gain) {
    using namespace arm_control;
    const Seconds tick{1.0 / setup.params.servo.rate_Hz};
    const std::size_t joints = setup.leader.joints.size();
    arm_plants::ArmPlant::Params held = setup.leader.arm;
    held.carried_kg = setup.params.person.hand.mass_kg;
    const auto leader = arm_plants::ArmPlant::make(held, setup.leader.start).value();
    const auto follower = arm_plants::ArmPlant::make(setup.follower.arm, setup.follower.start).value();
    ArmLeader::Params control = setup.params.control;
    control.force_gain = gain;
    control.model.hand = setup.exact.hand;
    const Joints<control::SafetyGate::Params> gates(joints, widest_gate());
    auto leads = leader_site(control, {.carried = setup.leader.arm.chain, .induced = setup.exact.induced, .gains = {}},
                             gates, tick)
                     .value();
    auto follows = follower_site(setup.params.control.follower,
                                 {.chain = setup.follower.arm.chain,
                                  .tool_m = setup.follower.arm.tool_m,
                                  .joint_stiffness_N_m_per_rad = setup.exact.follower_joint_stiffness_N_m_per_rad},
                                 gates, tick)
                       .value();
    Joints<double> start(joints);
    for (std::size_t i = 0; i < joints; ++i) start[i] = setup.leader.start[static_cast<Eigen::Index>(i)];
    const Joints<station::DeviceLimits> no_limits(joints);
    return {setup,
            {leader, no_limits},
            {follower, no_limits},
            arm_plants::ToolOperator::make(setup.params.person, tick, leader.tool()).value(),
            station::JointBarePair::around(std::move(leads), std::move(follows), {}, tick, start).value()};
  }

  /// One tick, the hand's aim that far from where it began. The wall's force, into the tool.
  double step(double aim_m, double aim_at_next_tick_m) {
    const auto at_leader = leader_.plant().tool();
    follower_.touches(glue());
    sites_.step(leader_, follower_, {.number = tick_++}, 1.0);
    person_.begin_tick(began_m_ + aim_m * outward_, began_m_ + aim_at_next_tick_m * outward_, at_leader);
    const double force_N = glue().force_N.dot(outward_);
    for (int i = 0; i < steps_; ++i) {
      leader_.step(person_.force(leader_.plant().tool(), i * step_s_));
      follower_.step(glue());
    }
    return force_N;
  }

 private:
  GluedPair(const experiments::ArmPairSetup& setup, arm_plants::ArmDevice leader, arm_plants::ArmDevice follower,
            arm_plants::ToolOperator person, station::JointBarePair sites)
      : leader_(std::move(leader)),
        follower_(std::move(follower)),
        person_(std::move(person)),
        sites_(std::move(sites)),
        outward_(setup.outward),
        began_m_(follower_.plant().tool().position_m),
        stiffness_(setup.params.wall.stiffness_N_per_m),
        damping_(setup.params.wall.damping_N_s_per_m),
        step_s_(setup.leader.arm.step_s),
        steps_(static_cast<int>(std::lround(1.0 / setup.params.servo.rate_Hz / setup.leader.arm.step_s))) {
    // Commands act and torques are told before the first tick: else the observer begins with a torque of the weight.
    station::JointBarePair at_rest = sites_;
    for (int tick = 0; tick < 2; ++tick) at_rest.step(leader_, follower_, {}, 1.0);
    leader_.step({});
    follower_.step({});
  }
  [[nodiscard]] arm_plants::ToolForce glue() const {
    const auto tool = follower_.plant().tool();
    const double force_N =
        -stiffness_ * outward_.dot(tool.position_m - began_m_) - damping_ * outward_.dot(tool.velocity_m_per_s);
    return {.force_N = force_N * outward_};
  }

  arm_plants::ArmDevice leader_, follower_;
  arm_plants::ToolOperator person_;
  station::JointBarePair sites_;
  arm::Vector3 outward_, began_m_;
  double stiffness_, damping_, step_s_;
  int steps_;
  std::int64_t tick_ = 0;
};

/// How fast what is left of a small kick grows on the simulated pair, at this gain, in 1/s.
inline double simulated_growth_per_s(const experiments::ArmPairSetup& setup, double gain) {
  constexpr double kick_m = 1e-7;
  constexpr double window_s = 0.5, first_s = 1.0, second_s = 2.0;
  GluedPair pair = GluedPair::make(setup, gain);
  const double dt_s = 1.0 / setup.params.servo.rate_Hz;
  std::vector<double> force_N;
  for (int k = 0; k * dt_s < second_s + window_s; ++k) {
    force_N.push_back(pair.step(k > 10 ? kick_m : 0.0, k > 9 ? kick_m : 0.0));
  }
  // Second differences leave out what is slow.
  const auto swing = [&](double from_s) {
    double sum = 0.0;
    constexpr std::size_t apart = 5;
    const auto from = static_cast<std::size_t>(from_s / dt_s),
               to = static_cast<std::size_t>((from_s + window_s) / dt_s);
    for (std::size_t i = from; i < to; ++i) {
      const double bend = force_N[i] - 2.0 * force_N[i - apart] + force_N[i - 2 * apart];
      sum += bend * bend;
    }
    return std::sqrt(sum);
  };
  return std::log(swing(second_s) / swing(first_s)) / (second_s - first_s);
}

}  // namespace tactus::arm_stability
