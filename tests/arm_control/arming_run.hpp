// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/kernel/station/site_pair.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

/// Two simulated arms that are armed by sites whose model of them may be wrong, in virtual time. The arms are MuJoCo's
/// and stay as they are; what is wrong is the model alone, or how joints and motors are connected.
namespace tactus::arming {

using control::SiteState;

/// What keeps an arm up before its motors do: it hangs, as low as it goes; it lies on a rest; a hand holds it.
enum class Before { hangs, rests, held };
constexpr auto enumerators(Before) {
  return std::array{Enumerator{Before::hangs, "hangs"}, Enumerator{Before::rests, "rests"},
                    Enumerator{Before::held, "held"}};
}

/// How the rig connects joints and motors: joint i reads and moves motor `motor[i]`, in the sense `sign[i]`.
struct Wiring {
  std::array<std::size_t, most_joints> motor{0, 1, 2, 3, 4, 5, 6, 7};
  std::array<double, most_joints> sign{1, 1, 1, 1, 1, 1, 1, 1};
};

inline arm::JointVector vector_of(std::size_t joints, double value) {
  return arm::JointVector::Constant(static_cast<Eigen::Index>(joints), value);
}

/// Where an arm comes to rest without power, from its zero, with some damping in its joints.
inline arm::JointVector hangs_at(const arm_plants::ArmPlant::Params& arm) {
  const arm::JointVector zero = vector_of(arm.motors.size(), 0.0);
  auto plant = *arm_plants::ArmPlant::make(arm, zero);
  arm::ArmCommand brakes = arm::ArmCommand::of_torque(zero);
  brakes.damping.setConstant(1.0);
  plant.write(brakes);
  constexpr int steps_between_looks = 1000, most_looks = 200;
  for (int look = 0; look < most_looks; ++look) {
    for (int i = 0; i < steps_between_looks; ++i) plant.step({});
    if (plant.link_velocity().cwiseAbs().maxCoeff() < 1e-4) break;
  }
  return plant.link_position();
}

/// An arm behind a bus of one cycle's delay, as the device of a site, with what keeps it up before its motors do.
///
/// A hand pulls each joint like a spring with a damper that swings at 3 Hz, and pulls harder for as long as the joint
/// stays away, as a person who keeps an arm where it is: so it bears the weight, and yields as the motors take over.
/// `let_go` opens it within half a second.
class ArmingDevice final : public station::JointDevice {
 public:
  ArmingDevice(arm_plants::ArmPlant::Params params, arm::JointVector at, Before before, const Wiring& wiring,
               const Joints<station::DeviceLimits>& limits)
      : wiring_(wiring), before_(before), limits_(limits), joints_(limits.size()), step_s_(params.step_s) {
    at_ = std::move(at);
    for (auto& motor : params.motors) motor.torque_limit_N_m = 1e9;  // the gates limit
    const arm::JointVector weight = arm_plants::ArmPlant::make(params, at_)->bearing_torque();
    if (before == Before::rests) {
      for (std::size_t i = 0; i < joints_; ++i) {
        const auto joint = static_cast<Eigen::Index>(i);
        auto& limit = params.chain.joints[i].limits;
        (weight[joint] > 0.0 ? limit.lower_rad : limit.upper_rad) = at_[joint];
      }
    }
    constexpr double swings = 2.0 * std::numbers::pi * 3.0;
    const arm::JointVector inertia = arm::Chain::make(params.chain)->mass_matrix(at_).diagonal();
    stiffness_ = swings * swings * inertia;
    damping_ = 1.4 * swings * inertia;
    bias_ = weight;
    plant_.emplace(*arm_plants::ArmPlant::make(params, at_));
  }

  [[nodiscard]] Joints<station::DeviceLimits> limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }
  Joints<station::DeviceReading> read(const station::Tick&) noexcept override {
    const arm::ArmReading now = plant_->read();
    Joints<station::DeviceReading> reading(joints_);
    for (std::size_t i = 0; i < joints_; ++i) {
      const auto motor = static_cast<Eigen::Index>(wiring_.motor[i]);
      reading[i].position_m = wiring_.sign[i] * now.position[motor];
      reading[i].motor_report = {.velocity_m_per_s = wiring_.sign[i] * now.velocity[motor],
                                 .force_N = wiring_.sign[i] * (now.torque[motor] - by_hand_[motor])};
    }
    return reading;
  }
  void write(const Joints<station::DeviceCommand>& command) noexcept override {
    acts_ = told_;
    told_ = command;
  }

  void let_go() noexcept { opens_ = true; }
  /// One tick of the arm.
  void advance(double tick_s) {
    for (int i = 0; i < std::lround(tick_s / step_s_); ++i) {
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
  [[nodiscard]] arm::ArmCommand of_motors() const {
    const arm::JointVector none = vector_of(joints_, 0.0);
    arm::ArmCommand acts{.position = none, .velocity = none, .stiffness = none, .damping = none, .torque = none};
    for (std::size_t i = 0; i < joints_; ++i) {
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
    if (opens_) grip_ = std::max(0.0, grip_ - step_s_ / opens_s);
    const arm::JointVector away = at_ - plant_->link_position();
    bias_ += corrects_per_s * step_s_ * stiffness_.cwiseProduct(away);
    // In one command with the motors' law: that of both is their sum.
    by_hand_ = grip_ * (bias_ + stiffness_.cwiseProduct(away) - damping_.cwiseProduct(plant_->link_velocity()));
    command.torque += by_hand_;
  }

  Wiring wiring_;
  Before before_;
  Joints<station::DeviceLimits> limits_;
  std::size_t joints_;
  double step_s_;
  arm::JointVector at_, stiffness_, damping_, bias_;
  arm::JointVector by_hand_ = vector_of(joints_, 0.0);  ///< what the hand adds, which no drive reports
  std::optional<arm_plants::ArmPlant> plant_;
  Joints<station::DeviceCommand> told_{joints_, {.enabled = false}}, acts_ = told_;
  bool opens_ = false;
  double grip_ = 1.0;
};

/// What became of an arm while it was armed.
struct Fate {
  double fastest_rad_per_s = 0.0;  ///< of any joint, from when the site has power until it released the arm
  double farthest_rad = 0.0;       ///< of any joint from where it began, the same
  double active_rad_per_s = 0.0;   ///< while the site was active
  bool powered = false;
  bool released = false;
  std::size_t fastest_joint = 0;
  double fastest_at_s = 0.0;
  control::SupportFinding found;
  control::SiteState state = control::SiteState::configure;
  control::SiteCause cause = control::SiteCause::none;
  control::GateFault fault = control::GateFault::none;  ///< of the first gate that has one
  std::size_t fault_joint = 0;
};

struct Arming {
  Fate leader, follower;
  double lasted_s = 0.0;
  [[nodiscard]] bool became_active() const {
    return leader.state == control::SiteState::active && follower.state == control::SiteState::active;
  }
  [[nodiscard]] bool refused() const { return !leader.powered && !follower.powered; }
  [[nodiscard]] double fastest() const { return std::max(leader.fastest_rad_per_s, follower.fastest_rad_per_s); }
  [[nodiscard]] double farthest() const { return std::max(leader.farthest_rad, follower.farthest_rad); }
};

template <class Site>
void look(const Site& site, const ArmingDevice& arm, double now_s, Fate& fate) {
  fate.state = site.state();
  fate.cause = site.cause();
  fate.found = site.support().found();
  fate.powered = fate.powered || site.state() != SiteState::configure;
  for (std::size_t i = 0; i < site.site().gates().size(); ++i) {
    const auto& gate = site.site().gates()[i].motor();
    fate.released = fate.released || gate.has_released();
    if (fate.fault != control::GateFault::none || gate.fault() == control::GateFault::none) continue;
    fate.fault = gate.fault();
    fate.fault_joint = i;
  }
  Eigen::Index fastest = 0;
  const double fast = arm.velocity().cwiseAbs().maxCoeff(&fastest);
  if (site.state() == SiteState::active) {
    fate.active_rad_per_s = std::max(fate.active_rad_per_s, fast);
  } else if (!fate.released && site.state() != SiteState::configure) {
    // Without power the site moves nothing: an arm that falls then is dropped by its hand.
    if (fast > fate.fastest_rad_per_s) {
      fate.fastest_joint = static_cast<std::size_t>(fastest);
      fate.fastest_at_s = now_s;
    }
    fate.fastest_rad_per_s = std::max(fate.fastest_rad_per_s, fast);
    fate.farthest_rad = std::max(fate.farthest_rad, (arm.position() - arm.began_at()).cwiseAbs().maxCoeff());
  }
}

inline std::string words_of(const char* whose, const Fate& fate) {
  const auto milli = [](double value) { return std::to_string(std::lround(1e3 * value)); };
  std::string words = std::string(whose) + " " + name_of(fate.state) + " (" + name_of(fate.cause) + ") " +
                      milli(fate.fastest_rad_per_s) + " mrad/s at joint " + std::to_string(fate.fastest_joint + 1) +
                      " after " + milli(fate.fastest_at_s) + " ms, " + milli(fate.farthest_rad) + " mrad";
  if (fate.fault != control::GateFault::none) {
    words += std::string(", gate ") + name_of(fate.fault) + " at joint " + std::to_string(fate.fault_joint + 1);
  }
  const control::SupportFinding& found = fate.found;
  if (found.fault == control::SupportFault::none) return words;
  return words + "; " + name_of(found.fault) + " at joint " + std::to_string(found.joint + 1) + ", share " +
         std::to_string(found.share) + ", " + milli(found.moved_m) + " mrad, " + milli(found.speed_m_per_s) +
         " mrad/s, " + milli(found.excess_N) + " of " + milli(found.weight_N) + " mN m";
}

inline std::string words_of(const Arming& arming) {
  return words_of("leader", arming.leader) + "; " + words_of("follower", arming.follower) + "; " +
         std::to_string(arming.lasted_s) + " s";
}

/// Arms both, as a program does: align, arm, dead-man switch. A hand that holds an arm releases it after `lets_go_s`.
/// It ends after `longest_s`, or a second after both are active, or after either has released its arm or refused it.
inline Arming arm_both(station::JointSupervisedPair& sites, ArmingDevice& leader, ArmingDevice& follower, double tick_s,
                       double lets_go_s, double longest_s) {
  constexpr double aligns_s = 0.02, begins_s = 0.04, after_s = 1.0;
  Arming arming;
  double over_s = 0.0;
  bool arms = false;
  for (std::int64_t number = 0; arming.lasted_s < longest_s && over_s < after_s; ++number) {
    const double now_s = arming.lasted_s = static_cast<double>(number) * tick_s;
    const bool aligned = sites.master().state() == SiteState::align && sites.slave().state() == SiteState::align;
    arms = arms || (aligned && now_s > begins_s);
    const bool armed = sites.master().state() == SiteState::armed || sites.master().state() == SiteState::active;
    sites.step(leader, follower, {.number = number}, {.align = now_s > aligns_s, .arm = arms, .dead_man = armed});
    leader.advance(tick_s);
    follower.advance(tick_s);
    look(sites.master(), leader, now_s, arming.leader);
    look(sites.slave(), follower, now_s, arming.follower);
    if (now_s > lets_go_s) {
      leader.let_go();
      follower.let_go();
    }
    const bool refused = now_s > begins_s && arming.leader.state == SiteState::configure &&
                         arming.follower.state == SiteState::configure;
    if (arming.became_active() || arming.leader.released || arming.follower.released || refused) over_s += tick_s;
  }
  return arming;
}

}  // namespace tactus::arming
