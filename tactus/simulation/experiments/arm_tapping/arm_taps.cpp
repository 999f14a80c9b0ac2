// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/signal/root_mean_square.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_tap_run.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>
#include <tactus/simulation/experiments/draws.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace tactus::experiments {

namespace {

constexpr double rest_s = 0.1;
constexpr double given_time_s = 0.15;
constexpr double window_s = 0.05;
constexpr double end_s = 0.1;
constexpr double far_below_m = -10.0;  ///< of a surface that nothing touches

std::vector<double> transient(std::span<const ArmRecord> records, double ArmRecord::*force, double tick_s) {
  std::vector<double> forces;
  forces.reserve(records.size());
  for (const ArmRecord& record : records) forces.push_back(record.*force);
  return force_transient(forces, tick_s);
}

/// What the controller's model believes instead of `value`.
double drawn(double value, double error, signal::Random& random) {
  return value * (1.0 + random.uniform(-error, error));
}

/// Mass and inertia.
void scale_body(arm::Body& body, double share) {
  for (double arm::Body::*part : {&arm::Body::mass_kg, &arm::Body::xx_kg_m2, &arm::Body::yy_kg_m2, &arm::Body::zz_kg_m2,
                                  &arm::Body::xy_kg_m2, &arm::Body::xz_kg_m2, &arm::Body::yz_kg_m2}) {
    body.*part *= share;
  }
}

void draw_errors(ArmTap& tap, double error, signal::Random& random) {
  for (arm::JointParams& joint : tap.model_params.induced.chain.joints) {
    scale_body(joint.body, drawn(1.0, error, random));
    joint.drive.armature_kg_m2 = drawn(joint.drive.armature_kg_m2, error, random);
    joint.friction.coulomb_N_m = drawn(joint.friction.coulomb_N_m, error, random);
    joint.friction.viscous_N_m_s_per_rad = drawn(joint.friction.viscous_N_m_s_per_rad, error, random);
  }
  auto& of_leader = tap.model_params.induced.joint_stiffness_N_m_per_rad;
  auto& of_follower = tap.model_params.follower_joint_stiffness_N_m_per_rad;
  for (Eigen::Index i = 0; i < std::max(of_leader.size(), of_follower.size()); ++i) {
    const double share = drawn(1.0, error, random);
    if (i < of_leader.size()) of_leader[i] *= share;
    if (i < of_follower.size()) of_follower[i] *= share;
  }
  arm::HandImpedance& hand = tap.model_params.hand;
  hand.mass_kg = drawn(hand.mass_kg, error, random);
  hand.stiffness_N_per_m = drawn(hand.stiffness_N_per_m, error, random);
  hand.damping_N_s_per_m = drawn(hand.damping_N_s_per_m, error, random);
}

/// What a site believes of an arm, and what that arm is.
void draw_site_errors(const ArmModelErrors& errors, const arm::Vector3& tool_m, signal::Random& random,
                      arm::Chain::Params& believed, arm::JointVector& torque_scale, double& payload_kg) {
  const auto joints = static_cast<Eigen::Index>(believed.joints.size());
  torque_scale.resize(joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    arm::JointParams& joint = believed.joints[static_cast<std::size_t>(i)];
    scale_body(joint.body, drawn(1.0, errors.mass, random));
    for (double arm::Body::*centre : {&arm::Body::centre_x_m, &arm::Body::centre_y_m, &arm::Body::centre_z_m}) {
      joint.body.*centre += random.uniform(-errors.centre_m, errors.centre_m);
    }
    joint.friction.coulomb_N_m = drawn(joint.friction.coulomb_N_m, errors.friction, random);
    joint.friction.viscous_N_m_s_per_rad = drawn(joint.friction.viscous_N_m_s_per_rad, errors.friction, random);
    torque_scale[i] = drawn(1.0, errors.torque_constant, random);
  }
  const double lacking_kg = random.uniform(-errors.payload_kg, errors.payload_kg);
  payload_kg = std::max(0.0, lacking_kg);
  believed = with_payload(believed, std::max(0.0, -lacking_kg), tool_m);
}

}  // namespace

ArmContact judge_arm_contact(std::span<const ArmRecord> records, std::size_t first_touch, double tick_s) {
  ArmContact found{.touched = true};
  const std::vector<double> contact = transient(records, &ArmRecord::contact_N, tick_s);
  const std::vector<double> hand = transient(records, &ArmRecord::hand_N, tick_s);
  const auto after = records.subspan(first_touch);
  for (const ArmRecord& record : after) found.peak_N = std::max(found.peak_N, record.contact_N);
  const std::size_t end = std::min(after.size(), ticks_in(end_s, tick_s));
  for (const ArmRecord& record : after.last(end)) found.steady_N += record.contact_N / static_cast<double>(end);
  const std::span<const double> of_contact(contact);
  found.residual_N = signal::root_mean_square(of_contact.last(end));
  const double touched_N = signal::root_mean_square(of_contact.subspan(first_touch));
  if (touched_N > 0.0)
    found.felt_share = signal::root_mean_square(std::span<const double>(hand).subspan(first_touch)) / touched_N;
  const double most_N = settled_share * found.peak_N / std::numbers::sqrt2;
  const std::size_t window = ticks_in(window_s, tick_s);
  for (std::size_t i = first_touch + ticks_in(given_time_s, tick_s); i + window <= contact.size(); ++i) {
    if (signal::root_mean_square(of_contact.subspan(i, window)) > most_N) found.rings = true;
  }
  std::size_t without = 0;
  for (std::size_t i = ticks_in(given_time_s, tick_s); i < after.size(); ++i) {
    without = after[i].contact_N > 0.0 ? 0 : without + 1;
    found.lost_s = std::max(found.lost_s, static_cast<double>(without) * tick_s);
  }
  return found;
}

ArmTapResult judge_arm_tap(const ArmContact& contact, bool diverged, const ArmContact& without_display) {
  return {.contact = contact,
          .ran_away =
              contact.peak_N > 1.6 * without_display.peak_N + 1.0 || contact.steady_N > 2.0 * without_display.steady_N,
          .diverged = diverged,
          .rings_at_gain_0 = without_display.rings};
}

Result<ArmTaps> ArmTaps::make(const ArmTappingParams& params, const std::filesystem::path& folder) {
  return make(params, urdf::urdfs_below(folder));
}

Result<ArmTaps> ArmTaps::make(const ArmTappingParams& params, const urdf::Urdfs& urdfs) {
  const ArmTappingTask& task = params.task;
  if (auto error = check_range(task.slowest_m_per_s, task.fastest_m_per_s, "slowest_m_per_s", "fastest_m_per_s")) {
    return *std::move(error);
  }
  if (auto error = check_range(task.shallowest_m, task.deepest_m, "shallowest_m", "deepest_m")) {
    return *std::move(error);
  }
  auto setup = set_up_arm_pair(params, urdfs);
  if (!setup) return setup.error();
  ArmTaps taps;
  taps.setup_ = *std::move(setup);
  const signal::Random random(static_cast<std::uint64_t>(task.seed));
  for (std::int64_t i = 0; i < task.taps; ++i) {
    signal::Random draw = random.fork(static_cast<std::uint64_t>(i));
    const double depth_m = draw.uniform(task.shallowest_m, task.deepest_m);
    const double speed_m_per_s = draw.uniform(task.slowest_m_per_s, task.fastest_m_per_s);
    ArmTap tap{.path = {.start_m = 0.0,
                        .end_m = -2.0 * depth_m,
                        .start_time_s = rest_s,
                        .duration_s = mechanics::MinimumJerk::duration_for(2.0 * depth_m, speed_m_per_s)},
               .wall_m = -depth_m,
               .model_params = taps.setup_.exact};
    draw_errors(tap, task.model_error, draw);
    if (task.errors.any()) {
      ArmPlantErrors& plants = tap.plant_errors;
      draw_site_errors(task.errors, taps.setup_.leader.arm.tool_m, draw, tap.model_params.leader,
                       plants.leader_torque_scale, plants.leader_payload_kg);
      draw_site_errors(task.errors, taps.setup_.follower.arm.tool_m, draw, tap.model_params.follower,
                       plants.follower_torque_scale, plants.follower_payload_kg);
    }
    taps.taps_.push_back(std::move(tap));
  }
  std::vector<Check> untared(taps.taps_.size());
  simulation::for_each_in_parallel(
      taps.taps_.size(),
      [&](std::size_t i) {
        untared[i] = tare_arms(taps.setup_, taps.taps_[i].plant_errors, taps.taps_[i].model_params);
      },
      [](double) {});
  for (Check& wrong : untared) {
    if (wrong) return *std::move(wrong);
  }
  const ArmTap& first = taps.taps_.front();
  if (const auto made = ArmPair::make(taps.setup_, first.model_params, first.wall_m, first.plant_errors); !made)
    return made.error();
  return taps;
}

ArmTaps::Contact ArmTaps::run_once(const ArmPairSetup& setup, const ArmTap& tap, ArmTrace* trace) const {
  ArmTapRun run = *ArmTapRun::make(setup, tap);
  for (std::int64_t tick = 0; !run.over(); ++tick) {
    run.step_sites({.number = tick});
    run.step_arms();
  }
  if (trace != nullptr) *trace = run.trace();
  return {.contact = run.contact(), .diverged = run.diverged()};
}

ArmTapResult ArmTaps::run(std::size_t tap, ArmTrace* trace) const {
  return run_at(setup_.params.control.force_gain, tap, run_without_display(tap), trace);
}

ArmContact ArmTaps::run_without_display(std::size_t tap) const {
  ArmPairSetup without = setup_;
  without.params.control.method = arm_control::ArmMethod::position_force;
  without.params.control.force_gain = 0.0;
  return run_once(without, taps_[tap], nullptr).contact;
}

ArmTapResult ArmTaps::run_at(double gain, std::size_t tap, const ArmContact& without_display, ArmTrace* trace) const {
  ArmPairSetup setup = setup_;
  setup.params.control.force_gain = gain;
  const Contact at_gain = run_once(setup, taps_[tap], trace);
  return judge_arm_tap(at_gain.contact, at_gain.diverged, without_display);
}

std::size_t ArmTaps::holds() const {
  constexpr std::size_t most = 4;
  return setup_.params.task.errors.any() ? std::min(most, taps_.size()) : 1;
}

ArmHold ArmTaps::hold(std::size_t tap) const {
  ArmPair pair = *ArmPair::make(setup_, taps_[tap].model_params, far_below_m, taps_[tap].plant_errors);
  ArmHold found;
  std::vector<double> forces_N;
  const arm::Vector3 still = arm::Vector3::Zero();
  for (std::size_t k = 0; k < ticks_in(setup_.params.task.hold_s, pair.tick_s()); ++k) {
    pair.step(still, still);
    forces_N.push_back(pair.hand_force_N().norm());
    found.drift_m = std::max(found.drift_m, pair.farthest_m());
  }
  found.force_N = signal::root_mean_square(forces_N);
  return found;
}

ArmReach ArmTaps::reach() const {
  const mechanics::MinimumJerk reach{.start_m = 0.0, .end_m = 0.2, .start_time_s = rest_s, .duration_s = 0.75};
  const ArmTap& tap = taps_.front();
  ArmPair pair = *ArmPair::make(setup_, tap.model_params, far_below_m, tap.plant_errors);
  ArmReach found;
  std::vector<double> forces_N, false_forces_N;
  for (std::size_t k = 0; k < ticks_in(rest_s + reach.duration_s, pair.tick_s()); ++k) {
    const double now_s = static_cast<double>(k) * pair.tick_s();
    const ArmRecord record =
        pair.step(reach.position_m(now_s) * setup_.outward, reach.position_m(now_s + pair.tick_s()) * setup_.outward);
    found.lag_m = std::max(found.lag_m, record.tools_apart_m);
    if (now_s < rest_s) continue;
    forces_N.push_back(record.hand_N);
    const ArmSnapshot snapshot = pair.snapshot();
    false_forces_N.push_back(snapshot.sent_N.norm());
    found.drift_m = std::max(found.drift_m, snapshot.induced_m.norm());
  }
  found.effort_N = signal::root_mean_square(forces_N);
  found.false_force_N = signal::root_mean_square(false_forces_N);
  return found;
}

ArmTappingMetrics summarise(const std::vector<ArmTapResult>& taps, const ArmReach& reach,
                            const std::vector<ArmHold>& held) {
  ArmHold hold;
  for (const ArmHold& one : held) {
    hold.force_N = std::max(hold.force_N, one.force_N);
    hold.drift_m = std::max(hold.drift_m, one.drift_m);
  }
  double longest_lost_s = 0.0;
  for (const ArmTapResult& tap : taps) longest_lost_s = std::max(longest_lost_s, tap.contact.lost_s);
  const auto share = [&](auto&& holds) {
    return static_cast<double>(std::count_if(taps.begin(), taps.end(), holds)) / static_cast<double>(taps.size());
  };
  const auto median = [&](double ArmContact::*value) {
    std::vector<double> values;
    for (const ArmTapResult& tap : taps) values.push_back(tap.contact.*value);
    return simulation::quantile(values, 0.5);
  };
  return {.taps = taps.size(),
          .settled_fraction = share([](const ArmTapResult& tap) { return tap.settled(); }),
          .rings_fraction = share([](const ArmTapResult& tap) { return tap.contact.rings; }),
          .ran_away_fraction = share([](const ArmTapResult& tap) { return tap.ran_away || tap.diverged; }),
          .peak_force_N = median(&ArmContact::peak_N),
          .steady_force_N = median(&ArmContact::steady_N),
          .residual_rms_N = median(&ArmContact::residual_N),
          .felt_share = median(&ArmContact::felt_share),
          .never_touched_fraction = share([](const ArmTapResult& tap) { return !tap.contact.touched; }),
          .rings_at_gain_0_fraction = share([](const ArmTapResult& tap) { return tap.rings_at_gain_0; }),
          .lost_fraction = share([](const ArmTapResult& tap) { return tap.contact.lost_s > most_lost_s; }),
          .longest_lost_s = longest_lost_s,
          .hold = hold,
          .reach = reach};
}

}  // namespace tactus::experiments
