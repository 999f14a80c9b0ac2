// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/hardware/devices/rig/rig_arms.hpp>
#include <tactus/hardware/devices/rig/rig_loop.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>
#include <tactus/runtime/servo/site_exchange.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include <tests/sweeps/position_bench.hpp>
#include <tests/sweeps/simulated_side.hpp>

namespace tactus::sweeps {

namespace {

using configuration::Document;
using control::SiteState;

const std::filesystem::path rigs_folder = std::filesystem::path(TACTUS_SOURCE_FOLDER) / "examples/rigs";

ShippedRig joint_by_joint(const char* rig_file, const char* experiment) {
  const auto params = Document::load(rigs_folder / experiment).value().read<experiments::TappingParams>().value();
  const auto rig = devices::Rig::load(rigs_folder / rig_file).value();
  const devices::RigPair& pair = rig.pairs().front();
  return {.name = rig_file,
          .rate_Hz = params.servo.rate_Hz,
          .pair = pair,
          .control = Joints<control::ControlParams>(pair.leader->joints.size(), experiments::sites_of(params).control),
          .channel = params.channel,
          .arms = std::nullopt};
}

ShippedRig as_arms(const char* rig_file, const char* experiment) {
  const auto params = Document::load(rigs_folder / experiment).value().read<experiments::ArmTappingParams>().value();
  const auto setup = experiments::set_up_arm_pair(params, rigs_folder).value();
  const auto rig = devices::Rig::load(rigs_folder / rig_file).value();
  return {.name = rig_file,
          .rate_Hz = params.servo.rate_Hz,
          .pair = devices::as_arms(rig.pairs().front(), params, setup).value(),
          .control = {},
          .channel = {},
          .arms = setup};
}

Joints<station::DeviceLimits> limits_of(const devices::RigSide& side) {
  Joints<station::DeviceLimits> limits(side.joints.size());
  for (std::size_t i = 0; i < limits.size(); ++i) limits[i] = side.joints[i].joint.limits();
  return limits;
}

devices::RigLoop loop_of(const ShippedRig& rig, runtime::SiteExchange& exchange, devices::MotorBusDevice& leader,
                         devices::MotorBusDevice& follower) {
  const Seconds tick{1.0 / rig.rate_Hz};
  devices::RigLoop::Params settings;
  if (!rig.arms) {
    settings.listen_before_arming_s = rig.control[0].supervision.watchdog.timeout_s;
    auto made = devices::RigLoop::make(rig.control, rig.channel, tick, settings, exchange, leader, follower);
    if (!made) throw std::runtime_error(rig.name + ": " + describe(made.error()));
    return *std::move(made);
  }
  settings.listen_before_arming_s = rig.arms->params.rig.supervision.watchdog.timeout_s;
  auto sites =
      station::arm_sites(rig.arms->params, *rig.arms, limits_of(*rig.pair.leader), limits_of(*rig.pair.follower));
  if (!sites) throw std::runtime_error(rig.name + ": " + describe(sites.error()));
  auto made = devices::RigLoop::around(*std::move(sites), tick, settings, exchange, leader, follower);
  if (!made) throw std::runtime_error(rig.name + ": " + describe(made.error()));
  return *std::move(made);
}

}  // namespace

std::vector<ShippedRig> shipped_rigs() {
  std::vector<ShippedRig> rigs;
  for (const char* file : {"openarm.toml", "yam.toml", "gello.toml", "so101.toml"}) {
    rigs.push_back(joint_by_joint(file, "joints.toml"));
  }
  rigs.push_back(joint_by_joint("inverse3.toml", "axes.toml"));
  rigs.push_back(as_arms("openarm-arms.toml", "arms.toml"));
  return rigs;
}

ShippedRig unjudged(ShippedRig rig) {
  constexpr control::MotionCheck::Params loose{.disagreement_m = 0.1, .velocity_error_m_per_s = 1.0, .lag_s = 0.1};
  for (std::size_t i = 0; i < rig.control.size(); ++i) {
    rig.control[i].gate.motion = loose;
    rig.control[i].slave_gate.motion = loose;
  }
  if (rig.arms) {
    rig.arms->params.rig.leader_gate.motion = loose;
    rig.arms->params.rig.follower_gate.motion = loose;
  }
  return rig;
}

std::size_t position_plans(const std::vector<ShippedRig>& rigs) {
  std::size_t joints = 0;
  for (const ShippedRig& rig : rigs) joints += 2 * rig.joints();
  return position_faults * joints;
}

PositionPlan position_plan(const std::vector<ShippedRig>& rigs, std::int64_t seed, std::size_t index) {
  PositionPlan plan;
  plan.seed = signal::Random(static_cast<std::uint64_t>(seed)).fork(index).bits();
  plan.fault = static_cast<PositionFault>(1 + index % position_faults);
  std::size_t joint = (index % position_plans(rigs)) / position_faults;
  while (joint >= 2 * rigs[plan.rig].joints()) joint -= 2 * rigs[plan.rig++].joints();
  plan.of_leader = joint < rigs[plan.rig].joints();
  plan.joint = joint % rigs[plan.rig].joints();
  return plan;
}

std::string words_of(const std::vector<ShippedRig>& rigs, const PositionPlan& plan) {
  const ShippedRig& rig = rigs[plan.rig];
  const devices::RigSide& side = plan.of_leader ? *rig.pair.leader : *rig.pair.follower;
  std::string words = rig.name + ", seed " + std::to_string(plan.seed);
  if (plan.fault == PositionFault::none) return words + (plan.contact ? ", in contact" : ", free");
  return words + ", " + side.joints[plan.joint].path + ": " + std::string(name_of(plan.fault));
}

std::string words_of(const PositionOutcome& outcome) {
  const devices::RigSecond& last = outcome.last;
  return std::string(outcome.followed ? "followed" : "never followed") +
         (outcome.released ? ", released" : ", not released") + " after " + std::to_string(outcome.travelled_rad) +
         " rad and " + std::to_string(outcome.ran_s) + " s; leader " + std::string(name_of(last.leader)) +
         ", follower " + std::string(name_of(last.follower)) + ", " + std::string(name_of(last.cause)) + ", gate " +
         std::string(name_of(last.fault)) + " of " + (last.fault_of_leader ? "leader" : "follower") + " joint " +
         std::to_string(last.fault_joint + 1) + ", devices " + std::string(name_of(last.leader_trouble.what)) + " " +
         std::string(name_of(last.follower_trouble.what));
}

PositionOutcome run(const ShippedRig& rig, const PositionPlan& plan) {
  signal::Random random(plan.seed);
  const station::DescribedArm* leader_arm = rig.arms ? &rig.arms->leader : nullptr;
  const station::DescribedArm* follower_arm = rig.arms ? &rig.arms->follower : nullptr;
  SimulatedSide leads(*rig.pair.leader, leader_arm, true, plan.contact, random.fork(1));
  SimulatedSide follows(*rig.pair.follower, follower_arm, false, plan.contact, random.fork(2));
  SimulatedSide& faulty = plan.of_leader ? leads : follows;
  auto leader = devices::MotorBusDevice::make(leads, {.joints = rig.pair.leader->motor_joints()}).value();
  auto follower = devices::MotorBusDevice::make(follows, {.joints = rig.pair.follower->motor_joints()}).value();
  runtime::SiteExchange exchange;
  devices::RigLoop loop = loop_of(rig, exchange, *leader, *follower);

  const double tick_s = 1.0 / rig.rate_Hz;
  const double fault_after_s = random.uniform(1.0, 4.0);
  constexpr double arms_s = 0.5, longest_to_arm_s = 40.0;
  PositionOutcome outcome;
  bool asked = false, faulted = false;
  for (std::int64_t number = 0;; ++number) {
    const double now_s = static_cast<double>(number) * tick_s;
    const auto now_ns = static_cast<std::int64_t>(1'000'000'000 + std::llround(1e9 * now_s));
    leads.advance(now_ns, tick_s);
    follows.advance(now_ns, tick_s);
    if (!asked && now_s > arms_s) asked = exchange.words.try_push(runtime::SiteWord::arm);
    loop({.number = number, .deadline_ns = now_ns, .began_ns = now_ns});
    while (auto second = loop.next_second()) outcome.last = *second;
    const auto& sites = loop.sites();
    leads.is_supported_by(sites.master().support().share(), rig.arms.has_value());
    follows.is_supported_by(sites.slave().support().share(), rig.arms.has_value());
    const bool leader_active = sites.master().state() == SiteState::active;
    const bool follower_active = sites.slave().state() == SiteState::active;
    if (!outcome.followed) {
      outcome.followed = leader_active && follower_active;
      if (outcome.followed) leads.begins_to_move();
      if (now_s > longest_to_arm_s) break;
      continue;
    }
    outcome.ran_s += tick_s;
    if (plan.fault == PositionFault::none) {
      outcome.released = !leader_active || !follower_active;
      if (outcome.released || outcome.ran_s >= plan.duration_s) break;
      continue;
    }
    if (!faulted && outcome.ran_s >= fault_after_s) {
      faulted = true;
      faulty.spoil(plan.joint, plan.fault);
    }
    if (!faulted && !(leader_active && follower_active)) break;  // a false trip
    outcome.released = plan.of_leader ? !leader_active : !follower_active;
    outcome.travelled_rad = faulty.travelled_rad();
    if (outcome.released || outcome.ran_s >= fault_after_s + plan.duration_s) break;
  }
  outcome.last = loop.last();
  return outcome;
}

}  // namespace tactus::sweeps
