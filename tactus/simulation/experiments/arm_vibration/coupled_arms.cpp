// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/experiments/arm_vibration/coupled_arms.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

namespace tactus::experiments {

using arm::JointVector;
using arm::Vector3;
using arm_plants::ArmPlant;
using arm_plants::KnownReading;
using arm_plants::PolledArm;
using arm_plants::ToolForce;

namespace {

constexpr double disturbed_at_s = 0.5;  ///< of the reach or push
constexpr double reach_lasts_s = 2.0, push_lasts_s = 0.1;
constexpr double record_s = 1e-3;
constexpr double judged_s = 1.0;
constexpr double moving_from_s = disturbed_at_s + 0.5;
constexpr double astray_rad = 2.0;

/// When a loop ticks: on a grid of its own, each tick late by a drawn time.
class LoopClock {
 public:
  LoopClock(const VibrationHost& host, double phase, signal::Random random)
      : period_s_(1.0 / host.rate_Hz), late_s_(host.late_s), random_(random), grid_s_(phase * period_s_) {
    next_s_ = grid_s_ + late_s_ * random_.uniform();
  }
  /// Whether it ticks at `now_s`; a tick that was missed is made up for at once.
  bool ticks(double now_s) {
    constexpr double same_s = 1e-9;
    if (now_s < next_s_ - same_s) return false;
    grid_s_ += period_s_;
    next_s_ = grid_s_ + late_s_ * random_.uniform();
    return true;
  }

 private:
  double period_s_;
  double late_s_;
  signal::Random random_;
  double grid_s_;
  double next_s_ = 0.0;
};

/// An arm with its loop in the host, and what the loop that exchanges readings has told it of the other.
struct HostedArm {
  PolledArm arm;
  LoopClock clock;
  KnownReading response;  ///< that the loop took over at its latest tick, for the exchange
  KnownReading other;
  JointVector told_at_s;  ///< when the other's drives read what this arm's drives go by

  void tick(const ReleasedLaw& law, double now_s) {
    response = arm.known();
    arm.tick(law.command(response.reading, other.reading.position, other.reading.velocity), now_s);
    for (Eigen::Index i = 0; i < told_at_s.size(); ++i) {
      if (arm.heard(static_cast<int>(i))) told_at_s[i] = other.at_s[i];
    }
  }
};

struct Told {
  std::vector<double> position, velocity;
};
using ToldByJoint = std::vector<Told>;

PolledArm::Params bus_of(const CoupledArmsSetup& setup, std::uint64_t stream) {
  const ArmVibrationParams& p = setup.params;
  PolledArm::Params bus{.answer_ticks = static_cast<int>(p.host.answer_ticks),
                        .lost_share = Joints<double>(setup.arm.motors.size(), 0.0),
                        .seed = signal::Random(static_cast<std::uint64_t>(p.task.seed)).fork(stream).bits()};
  bus.lost_share[setup.joint] = p.cause.lost_share;
  bus.outage_ticks = std::max(1.0 / (1.0 - p.cause.lost_share), p.cause.outage_s * p.host.rate_Hz);
  return bus;
}

Result<HostedArm> hosted(const CoupledArmsSetup& setup, const ArmPlant::Params& arm, double phase,
                         std::uint64_t stream) {
  auto plant = ArmPlant::make(arm, setup.start);
  if (!plant) return under("arm", plant.error());
  auto polled = PolledArm::make(bus_of(setup, stream), *std::move(plant), 0.0);
  if (!polled) return under("cause", polled.error());
  const signal::Random random = signal::Random(static_cast<std::uint64_t>(setup.params.task.seed)).fork(stream + 2);
  const KnownReading known = polled->known();
  return HostedArm{.arm = *std::move(polled),
                   .clock = LoopClock(setup.params.host, phase, random),
                   .response = known,
                   .other = known,
                   .told_at_s = known.at_s};
}

/// In the second from there on. Of both arms that which shakes more counts, for each joint.
ShakingArms shaking_arms(const std::array<ToldByJoint, 2>& told, std::size_t joint, double from_s) {
  constexpr double rate_Hz = 1.0 / record_s;
  const auto judged = [&](const std::vector<double>& values) {
    return std::span(values).subspan(static_cast<std::size_t>(std::lround(from_s / record_s)),
                                     static_cast<std::size_t>(std::lround(judged_s / record_s)));
  };
  struct Strongest {
    double rms_rad_per_s;
    const Told* told;
  };
  std::vector<Strongest> joints;
  for (std::size_t i = 0; i < told[0].size(); ++i) {
    const double leader = shaking_rms_of(judged(told[0][i].velocity), rate_Hz);
    const double follower = shaking_rms_of(judged(told[1][i].velocity), rate_Hz);
    joints.push_back(leader > follower ? Strongest{leader, &told[0][i]} : Strongest{follower, &told[1][i]});
  }
  std::size_t worst = joint;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].rms_rad_per_s > joints[worst].rms_rad_per_s) worst = i;
  }
  const auto shaking = [&](std::size_t i) {
    return shaking_of(judged(joints[i].told->position), judged(joints[i].told->velocity), rate_Hz);
  };
  return {.joint = shaking(joint), .worst_joint = worst, .worst = shaking(worst)};
}

/// As the drives have it, by their own ranges: what the host makes of a velocity is not how the arm moves.
void note(const ArmPlant& plant, const Joints<arm_plants::MotorParams>& motors, ToldByJoint& told) {
  const arm::ArmReading reading = plant.read();
  for (std::size_t i = 0; i < told.size(); ++i) {
    told[i].position.push_back(reading.position[static_cast<Eigen::Index>(i)]);
    told[i].velocity.push_back(reading.velocity[static_cast<Eigen::Index>(i)] / motors[i].velocity_scale);
  }
}

double push_N(const ArmVibrationTask& task, double now_s) {
  const double since_s = now_s - disturbed_at_s;
  return since_s < 0.0 || since_s > push_lasts_s ? 0.0
                                                 : task.push_N * std::sin(std::numbers::pi * since_s / push_lasts_s);
}

}  // namespace

Result<CoupledArmsSetup> set_up_coupled_arms(const ArmVibrationParams& params, const std::filesystem::path& folder) {
  auto described = urdf::describe_arm(params.arm, urdf::urdfs_below(folder));
  if (!described) return described.error();
  const auto chain = arm::Chain::make(described->arm.chain);
  if (!chain) return under("arm", chain.error());
  if (params.task.joint > chain->joints()) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "task.joint",
                 .message = std::to_string(params.task.joint) + ": the arm has " + std::to_string(chain->joints()) +
                            " joints: write one of them",
                 .place = {}};
  }
  CoupledArmsSetup setup{.params = params,
                         .believed = described->arm.chain,
                         .arm = described->arm,
                         .start = described->start,
                         .joint = static_cast<std::size_t>(params.task.joint - 1)};
  setup.arm.step_s = params.host.plant_step_s;
  for (arm::JointParams& joint : setup.arm.chain.joints) {
    joint.friction.coulomb_N_m *= params.cause.friction_share;
    joint.friction.viscous_N_m_s_per_rad *= params.cause.friction_share;
  }
  if (params.cause.play_rad > 0.0) {
    arm_plants::MotorParams& motor = setup.arm.motors[setup.joint];
    motor.play_rad = params.cause.play_rad;
    motor.joint_stiffness_N_m_per_rad = params.cause.flank_stiffness_N_m_per_rad;
    motor.joint_damping_N_m_s_per_rad = params.cause.flank_damping_N_m_s_per_rad;
  }
  const Vector3 moves = chain->jacobian(setup.start, chain->joints() - 1, setup.arm.tool_m)
                            .topRows<3>()
                            .col(static_cast<Eigen::Index>(setup.joint));
  if (moves.norm() > 1e-6) setup.direction = moves.normalized();
  return setup;
}

Result<CoupledArmsResult> run_coupled_arms(const CoupledArmsSetup& setup) {
  const ArmVibrationParams& p = setup.params;
  const bool held = p.task.held_by == HeldBy::hand;
  const auto law = ReleasedLaw::make(p.control, setup.believed);
  if (!law) return under("control", law.error());
  ArmPlant::Params leader_arm = setup.arm;
  if (held) leader_arm.carried_kg = p.person.hand.mass_kg;
  leader_arm.motors[setup.joint].velocity_scale = p.cause.velocity_scale;
  auto leader = hosted(setup, leader_arm, 0.0, 0);
  if (!leader) return leader.error();
  auto follower = hosted(setup, setup.arm, p.host.follower_phase, 1);
  if (!follower) return follower.error();
  const signal::Random random = signal::Random(static_cast<std::uint64_t>(p.task.seed)).fork(4);
  LoopClock exchange(p.host, p.host.exchange_phase, random);
  auto person = arm_plants::ToolOperator::make(p.person, Seconds{record_s}, leader->arm.plant().tool());
  if (!person) return under("operator", person.error());
  const Vector3 began_m = leader->arm.plant().tool().position_m;
  const mechanics::MinimumJerk reach{
      .start_m = 0.0, .end_m = p.task.reach_m, .start_time_s = disturbed_at_s, .duration_s = reach_lasts_s};
  const auto path = [&](double now_s) { return Vector3(began_m + reach.position_m(now_s) * setup.direction); };
  const auto at = static_cast<Eigen::Index>(setup.joint);
  const auto chain = arm::Chain::make(setup.believed);
  if (!chain) return chain.error();

  CoupledArmsResult result;
  std::array<ToldByJoint, 2> told{ToldByJoint(setup.arm.motors.size()), ToldByJoint(setup.arm.motors.size())};
  const double step_s = p.host.plant_step_s;
  const auto steps_a_record = static_cast<std::int64_t>(std::lround(record_s / step_s));
  const auto steps = static_cast<std::int64_t>(std::lround(p.task.duration_s / record_s)) * steps_a_record;
  double age_s = 0.0, ages = 0.0;
  for (std::int64_t k = 0; k < steps; ++k) {
    const double now_s = static_cast<double>(k) * step_s;
    if (exchange.ticks(now_s)) {
      leader->other = follower->response;
      follower->other = leader->response;
    }
    if (leader->clock.ticks(now_s)) leader->tick(*law, now_s);
    if (follower->clock.ticks(now_s)) follower->tick(*law, now_s);
    if (k % steps_a_record == 0) {
      if (held) person->begin_tick(path(now_s), path(now_s + record_s), leader->arm.plant().tool());
      note(leader->arm.plant(), leader_arm.motors, told[0]);
      note(follower->arm.plant(), setup.arm.motors, told[1]);
      const arm::ArmReading l = leader->arm.plant().read(), f = follower->arm.plant().read();
      result.records.push_back({.leader_rad = l.position[at],
                                .follower_rad = f.position[at],
                                .leader_rad_per_s = l.velocity[at],
                                .follower_rad_per_s = f.velocity[at],
                                .leader_N_m = l.torque[at] - chain->gravity_torque(l.position)[at],
                                .follower_N_m = f.torque[at] - chain->gravity_torque(f.position)[at]});
      const double off_rad =
          std::max((l.position - setup.start).cwiseAbs().maxCoeff(), (f.position - setup.start).cwiseAbs().maxCoeff());
      result.diverged = result.diverged || !leader->arm.plant().healthy() || !follower->arm.plant().healthy() ||
                        !(off_rad < astray_rad);
    }
    if (now_s >= p.task.duration_s - judged_s) {
      age_s += now_s - 0.5 * (leader->told_at_s[at] + follower->told_at_s[at]);
      ages += 1.0;
    }
    const double since_s = static_cast<double>(k % steps_a_record) * step_s;
    leader->arm.step(held ? person->force(leader->arm.plant().tool(), since_s)
                          : ToolForce{.force_N = push_N(p.task, now_s) * setup.direction});
    follower->arm.step({});
  }
  result.delay_s = age_s / ages;
  result.weight_N_m = chain->gravity_torque(follower->arm.plant().link_position())[at];
  result.moving = shaking_arms(told, setup.joint, moving_from_s);
  result.resting = shaking_arms(told, setup.joint, p.task.duration_s - judged_s);
  return result;
}

Result<CoupledArmsTheory> theory_of(const CoupledArmsSetup& setup) {
  const auto chain = arm::Chain::make(setup.believed);
  if (!chain) return chain.error();
  const auto law = ReleasedLaw::make(setup.params.control, setup.believed);
  if (!law) return law.error();
  const int joints = chain->joints();
  const arm::JointMatrix none = arm::JointMatrix::Zero(joints, joints);
  const arm_control::CoupledArm free{.inertia = chain->mass_matrix(setup.start), .damping = none, .stiffness = none};
  arm_control::CoupledArm leader = free;
  if (setup.params.task.held_by == HeldBy::hand) {
    const arm::HandImpedance& hand = setup.params.person.hand;
    const arm::Jacobian tool = chain->jacobian(setup.start, joints - 1, setup.arm.tool_m);
    const arm::JointMatrix moving = tool.topRows<3>().transpose() * tool.topRows<3>();
    const arm::JointMatrix turning = tool.bottomRows<3>().transpose() * tool.bottomRows<3>();
    const double lever2_m2 = hand.lever_m * hand.lever_m;
    leader.inertia += hand.mass_kg * moving;
    leader.damping += hand.damping_N_s_per_m * (moving + lever2_m2 * turning);
    leader.stiffness += hand.stiffness_N_per_m * (moving + lever2_m2 * turning);
  }
  const arm_control::PositionCoupling coupling{
      .stiffness = law->stiffness(), .damping = law->damping(), .velocity_share = setup.params.control.velocity_share};
  const auto at = static_cast<Eigen::Index>(setup.joint);
  arm::JointVector scale = arm::JointVector::Ones(joints);
  scale[at] = setup.params.cause.velocity_scale;
  return CoupledArmsTheory{.arms = arm_control::delay_limit(leader, free, coupling),
                           .motor = arm_control::delay_limit_of_joint(
                               coupling.stiffness[at], coupling.damping[at],
                               setup.believed.joints[setup.joint].drive.reflected_kg_m2(), coupling.velocity_share),
                           .growth_per_s = arm_control::growth_per_s(leader, free, coupling, scale)};
}

}  // namespace tactus::experiments
