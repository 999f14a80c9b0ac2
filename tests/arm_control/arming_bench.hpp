#pragma once

#include <tactus/data/urdf/urdf.hpp>
#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/arm_control/arm_sites.hpp>
#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/control/support_law.hpp>
#include <tactus/kernel/station/site_pair.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

/// Two simulated arms that are armed by sites whose model of them may be wrong, in virtual time. The arms are MuJoCo's
/// and stay as they are; what is wrong is the model alone, or how joints and motors are connected.
namespace tactus::arm_control {
namespace arming_test {

using control::SiteState;

inline constexpr std::size_t joints = 7;
inline constexpr double tick_s = 2e-3, plant_step_s = 2e-4;

/// What keeps an arm up before its motors do.
enum class Before { hangs, rests, held };
constexpr auto enumerators(Before) {
  return std::array{Enumerator{Before::hangs, "hangs"}, Enumerator{Before::rests, "rests"},
                    Enumerator{Before::held, "held"}};
}

/// How the rig connects joints and motors: joint i reads and moves motor `motor[i]`, in the sense `sign[i]`.
struct Wiring {
  std::array<std::size_t, joints> motor{0, 1, 2, 3, 4, 5, 6};
  std::array<double, joints> sign{1, 1, 1, 1, 1, 1, 1};
};

inline arm::JointVector vector_of(double value) {
  return arm::JointVector::Constant(static_cast<Eigen::Index>(joints), value);
}

/// An arm behind a bus of one cycle's delay, as the device of a site, with what keeps it up before its motors do.
///
/// A hand pulls each joint like a spring with a damper that swings at 3 Hz, and pulls harder for as long as the joint
/// stays away, as a person who keeps an arm where it is: so it bears the weight, and yields as the motors take over.
/// `let_go` opens it within half a second.
class ArmingDevice final : public station::JointDevice {
 public:
  ArmingDevice(arm_plants::ArmPlant::Params params, arm::JointVector at, Before before, const Wiring& wiring)
      : wiring_(wiring), before_(before), at_(std::move(at)) {
    params.step_s = plant_step_s;
    for (auto& motor : params.motors) motor.torque_limit_N_m = 1e9;  // the gates limit
    if (before == Before::hangs) come_to_rest(params);
    weight_ = arm_plants::ArmPlant::make(params, at_)->bearing_torque();
    if (before == Before::rests) {
      for (std::size_t i = 0; i < joints; ++i) {
        const auto joint = static_cast<Eigen::Index>(i);
        auto& limit = params.chain.joints[i].limits;
        (weight_[joint] > 0.0 ? limit.lower_rad : limit.upper_rad) = at_[joint];
      }
    }
    const auto chain = arm::Chain::make(params.chain);
    constexpr double swings = 2.0 * std::numbers::pi * 3.0;
    stiffness_ = swings * swings * chain->mass_matrix(at_).diagonal();
    damping_ = 1.4 * swings * chain->mass_matrix(at_).diagonal();
    bias_ = weight_;
    auto made = arm_plants::ArmPlant::make(params, at_);
    EXPECT_TRUE(made) << describe(made.error());
    plant_.emplace(*std::move(made));
  }

  [[nodiscard]] Joints<station::DeviceLimits> limits() const override { return Joints<station::DeviceLimits>(joints); }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }
  Joints<station::DeviceReading> read(const station::Tick&) noexcept override {
    const arm::ArmReading now = plant_->read();
    Joints<station::DeviceReading> reading(joints);
    for (std::size_t i = 0; i < joints; ++i) {
      const auto motor = static_cast<Eigen::Index>(wiring_.motor[i]);
      reading[i].position_m = wiring_.sign[i] * now.position[motor];
      reading[i].motor_report = {.velocity_m_per_s = wiring_.sign[i] * now.velocity[motor],
                                 .force_N = wiring_.sign[i] * now.torque[motor]};
    }
    return reading;
  }
  void write(const Joints<station::DeviceCommand>& command) noexcept override {
    acts_ = told_;
    told_ = command;
  }

  void let_go() noexcept { opens_ = true; }
  /// One tick of the arm.
  void advance() {
    for (int i = 0; i < std::lround(tick_s / plant_step_s); ++i) {
      arm::ArmCommand command = of_motors();
      add_hand(command);
      plant_->write(command);
      plant_->step({});
    }
  }
  [[nodiscard]] arm::JointVector position() const { return plant_->link_position(); }
  [[nodiscard]] arm::JointVector velocity() const { return plant_->link_velocity(); }
  [[nodiscard]] const arm::JointVector& began_at() const { return at_; }

 private:
  void come_to_rest(const arm_plants::ArmPlant::Params& params) {
    auto plant = arm_plants::ArmPlant::make(params, vector_of(0.0));
    arm::ArmCommand brakes = arm::ArmCommand::of_torque(vector_of(0.0));
    brakes.damping.setConstant(1.0);
    plant->write(brakes);
    constexpr int steps_between_looks = 1000, most_looks = 100;
    for (int look = 0; look < most_looks; ++look) {
      for (int i = 0; i < steps_between_looks; ++i) plant->step({});
      if (plant->link_velocity().cwiseAbs().maxCoeff() < 1e-4) break;
    }
    at_ = plant->link_position();
  }
  [[nodiscard]] arm::ArmCommand of_motors() const {
    const arm::JointVector none = vector_of(0.0);
    arm::ArmCommand acts{.position = none, .velocity = none, .stiffness = none, .damping = none, .torque = none};
    for (std::size_t i = 0; i < joints; ++i) {
      const auto motor = static_cast<Eigen::Index>(wiring_.motor[i]);
      if (!acts_[i].enabled) continue;
      acts.position[motor] = wiring_.sign[i] * acts_[i].law.position_m;
      acts.velocity[motor] = wiring_.sign[i] * acts_[i].law.velocity_m_per_s;
      acts.stiffness[motor] = acts_[i].law.stiffness_N_per_m;
      acts.damping[motor] = acts_[i].law.damping_N_s_per_m;
      acts.torque[motor] = wiring_.sign[i] * acts_[i].force_N;
    }
    return acts;
  }
  void add_hand(arm::ArmCommand& command) {
    if (before_ != Before::held) return;
    constexpr double opens_s = 0.5, corrects_per_s = 4.0;
    if (opens_) grip_ = std::max(0.0, grip_ - plant_step_s / opens_s);
    const arm::JointVector away = at_ - plant_->link_position();
    bias_ += corrects_per_s * plant_step_s * stiffness_.cwiseProduct(away);
    // In one command with the motors' law: that of both is their sum.
    command.torque += grip_ * (bias_ + stiffness_.cwiseProduct(away) - damping_.cwiseProduct(plant_->link_velocity()));
  }

  Wiring wiring_;
  Before before_;
  arm::JointVector at_;
  arm::JointVector weight_, stiffness_, damping_, bias_;
  std::optional<arm_plants::ArmPlant> plant_;
  Joints<station::DeviceCommand> told_{joints, {.enabled = false}}, acts_ = told_;
  bool opens_ = false;
  double grip_ = 1.0;
};

/// The arm as it is: with the friction of its URDF and the steps in which its drives report.
inline const arm_plants::ArmPlant::Params& true_arm() {
  static const arm_plants::ArmPlant::Params arm = [] {
    const auto read = urdf::read(std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/openarm-class.urdf");
    EXPECT_TRUE(read) << describe(read.error());
    constexpr double armature_kg_m2[] = {0.0167, 0.0167, 0.029, 0.029, 0.0018, 0.0018, 0.0018};
    arm_plants::ArmPlant::Params params{.chain = read->params,
                                        .motors = Joints<arm_plants::MotorParams>(joints),
                                        .tool_m = arm::Vector3(0.0, 0.0, 0.15)};
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
  each.probe = {.duration_s = 0.5, .least_m = 0.0015, .most_m = 0.3};
  each.overload.missed_share = 0.5;
  each.force_sensor.residual_limit_N = each.hand_sensor.residual_limit_N = 200.0;
  Joints<control::SupervisionParams> all(joints, each);
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

/// What became of an arm while it was armed.
struct Fate {
  double fastest_rad_per_s = 0.0;  ///< of any joint, until the site let go
  double farthest_rad = 0.0;       ///< of any joint from where it began, the same
  double active_rad_per_s = 0.0;   ///< while the site was active
  bool powered = false;
  bool let_go = false;
  Eigen::Index fastest_joint = 0;
  double fastest_at_s = 0.0;
  control::SupportFinding found;
};

struct Outcome {
  Fate leader, follower;
  SiteState leader_state = SiteState::configure, follower_state = SiteState::configure;
  control::SiteCause leader_cause = control::SiteCause::none, follower_cause = control::SiteCause::none;
  double lasted_s = 0.0;
  [[nodiscard]] bool became_active() const {
    return leader_state == SiteState::active && follower_state == SiteState::active;
  }
  [[nodiscard]] double fastest() const { return std::max(leader.fastest_rad_per_s, follower.fastest_rad_per_s); }
  [[nodiscard]] double farthest() const { return std::max(leader.farthest_rad, follower.farthest_rad); }
};

/// Arms both by a model `believed` of each, as a program does: align, arm, dead-man. A hand that holds lets go after
/// 4.2 s. It ends a second after both are active, or after either has let go or refused.
inline Outcome arm_both(const arm::Chain::Params& believed, Before before, const Wiring& wiring = {},
                        double raise_s = 4.0) {
  station::JointSupervisedPair sites = sites_of(believed, raise_s);
  ArmingDevice leader(true_arm(), start(), before, wiring), follower(true_arm(), start(), before, wiring);
  Outcome outcome;
  std::int64_t number = 0;
  const auto see = [&number](const ArmingDevice& arm, Fate& fate, const auto& site) {
    fate.powered = fate.powered || site.state() != SiteState::configure;
    for (const auto& gates : site.site().gates()) fate.let_go = fate.let_go || gates.motor().has_released();
    const double fast = arm.velocity().cwiseAbs().maxCoeff();
    if (site.state() == SiteState::active) {
      fate.active_rad_per_s = std::max(fate.active_rad_per_s, fast);
    } else if (!fate.let_go) {
      if (fast > fate.fastest_rad_per_s) {
        arm.velocity().cwiseAbs().maxCoeff(&fate.fastest_joint);
        fate.fastest_at_s = static_cast<double>(number) * tick_s;
      }
      fate.fastest_rad_per_s = std::max(fate.fastest_rad_per_s, fast);
      fate.farthest_rad = std::max(fate.farthest_rad, (arm.position() - arm.began_at()).cwiseAbs().maxCoeff());
    }
  };
  constexpr double longest_s = 16.0, lets_go_s = 4.2, after_s = 1.0;
  double over_s = 0.0;
  bool arms = false;
  for (; static_cast<double>(number) * tick_s < longest_s && over_s < after_s; ++number) {
    const bool aligned = sites.master().state() == SiteState::align && sites.slave().state() == SiteState::align;
    arms = arms || (aligned && number > 20);
    const bool armed = sites.master().state() == SiteState::armed || sites.master().state() == SiteState::active;
    const control::SiteRequests asked{.align = number > 10, .arm = arms, .dead_man = armed};
    sites.step(leader, follower, {.number = number, .missed = 0}, asked);
    leader.advance();
    follower.advance();
    see(leader, outcome.leader, sites.master());
    see(follower, outcome.follower, sites.slave());
    if (static_cast<double>(number) * tick_s > lets_go_s) {
      leader.let_go();
      follower.let_go();
    }
    outcome.leader_state = sites.master().state();
    outcome.follower_state = sites.slave().state();
    outcome.leader.found = sites.master().support().found();
    outcome.follower.found = sites.slave().support().found();
    outcome.leader_cause = sites.master().cause();
    outcome.follower_cause = sites.slave().cause();
    const bool refused =
        number > 20 && outcome.leader_state == SiteState::configure && outcome.follower_state == SiteState::configure;
    if (outcome.became_active() || outcome.leader.let_go || outcome.follower.let_go || refused) over_s += tick_s;
    outcome.lasted_s = static_cast<double>(number) * tick_s;
  }
  return outcome;
}

}  // namespace arming_test
}  // namespace tactus::arm_control
