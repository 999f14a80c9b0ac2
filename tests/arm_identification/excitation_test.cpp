// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/excitation.hpp>
#include <tactus/identification/arm/external_torque.hpp>
#include <tactus/identification/arm/fit.hpp>
#include <tactus/identification/arm/minimise.hpp>
#include <tactus/identification/arm/motion_information.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/arm_identification/kdl_arm.hpp"
#include <gtest/gtest.h>

namespace tactus::arm_identification {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double left_N_m = 0.005;  ///< about what a model leaves of the simulated efforts below 10 Hz

/// The first joints of the simulated arm as a URDF has them, with limits.
arm::Chain::Params limited(std::size_t joints) {
  const arm::Chain::Params whole = believed(open_arm(), 3);
  constexpr std::array<double, 7> efforts{15, 15, 9, 9, 3, 3, 3};
  arm::Chain::Params params{.joints = Joints<arm::JointParams>(joints), .gravity = whole.gravity};
  for (std::size_t j = 0; j < joints; ++j) {
    params.joints[j] = whole.joints[j];
    params.joints[j].limits = {
        .lower_rad = -2.0, .upper_rad = 2.0, .velocity_rad_per_s = 6.0, .effort_N_m = efforts[j]};
  }
  return params;
}

std::vector<std::string> names_of(std::size_t joints) {
  std::vector<std::string> found;
  for (std::size_t j = 1; j <= joints; ++j) found.push_back("j" + std::to_string(j));
  return found;
}

ExcitationRequest request_of(std::size_t joints) {
  ExcitationRequest request;
  request.noise_N_m.assign(joints, left_N_m);
  return request;
}

ArmRecording recorded_of(const Samples& samples) {
  const std::vector<std::string> joints = names_of(samples.position.size());
  ArmRecording recording{.file = "simulated.csv",
                         .position_names = joints,
                         .effort_names = joints,
                         .sample_time = Seconds{samples.time_s[1]}};
  recording.position = samples.position;
  recording.velocity = samples.velocity;
  recording.effort = samples.torque;
  return recording;
}

TEST(Minimise, FindsTheBottomOfACurvedValley) {
  const SmoothCost valley = [](const VectorXd& at, VectorXd& slope) {
    const double a = 1.0 - at[0];
    const double b = at[1] - at[0] * at[0];
    slope << -2.0 * a - 400.0 * at[0] * b, 200.0 * b;
    return a * a + 100.0 * b * b;
  };
  const VectorXd found = minimise(valley, VectorXd::Constant(2, -1.2), 200);
  EXPECT_NEAR(found[0], 1.0, 1e-4);
  EXPECT_NEAR(found[1], 1.0, 1e-4);
}

TEST(FourierMotion, BeginsAndEndsAtRestAndMovesAsItsSlopesSay) {
  signal::Random random(2);
  MatrixXd coordinates(2, FourierMotion::coordinates(4));
  for (double& value : coordinates.reshaped()) value = random.normal();
  const FourierMotion motion(5.0, 4, coordinates);
  for (const double t : {0.0, 5.0, 10.0}) {
    EXPECT_LT(motion.at(t).velocity.norm(), 1e-12);
    EXPECT_LT(motion.at(t).acceleration.norm(), 1e-11);
    EXPECT_LT((motion.at(t).position - motion.at(0.0).position).norm(), 1e-12);
  }
  constexpr double h = 1e-5;
  for (const double t : {0.3, 1.7, 4.1}) {
    const FourierMotion::State before = motion.at(t - h);
    const FourierMotion::State after = motion.at(t + h);
    EXPECT_LT((after.position - before.position - 2.0 * h * motion.at(t).velocity).norm(), 1e-12);
    EXPECT_LT((after.velocity - before.velocity - 2.0 * h * motion.at(t).acceleration).norm(), 1e-12);
  }
}

TEST(MotionInformation, TheSlopeOfTheCostIsThatOfItsDifferences) {
  arm::Chain::Params params = limited(3);
  for (arm::JointParams& joint : params.joints) joint.friction.velocity_scale_rad_per_s = 0.3;
  std::vector<JointPrior> priors;
  for (const arm::JointParams& joint : params.joints) {
    priors.push_back({.body = joint.body, .armature = 0.01, .coulomb = 0.2, .viscous = 0.1, .torque = 2.0});
  }
  const MotionLimits limits{.lower = arm::JointVector::Constant(3, -0.5),
                            .upper = arm::JointVector::Constant(3, 0.5),
                            .velocity = arm::JointVector::Constant(3, 0.5),
                            .effort = arm::JointVector::Constant(3, 0.5),
                            .box_lower_m = arm::Vector3::Constant(0.0),
                            .box_upper_m = arm::Vector3::Constant(0.1),
                            .points = {{}, {}, {arm::Vector3(0.0, 0.0, 0.1)}}};
  const MotionInformation information(*arm::Chain::make(params), fit_of_nothing(priors),
                                      arm::JointVector::Constant(3, 0.1), 20.0, limits);
  constexpr int harmonics = 3;
  signal::Random random(4);
  VectorXd at(3 * FourierMotion::coordinates(harmonics));
  for (double& value : at) value = random.normal();
  VectorXd slope(at.size());
  constexpr double firmness = 3.0;
  information.cost(at, 6.0, harmonics, 30, firmness, &slope);
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    constexpr double h = 1e-5;
    VectorXd moved = at;
    moved[i] += h;
    const double above = information.cost(moved, 6.0, harmonics, 30, firmness, nullptr);
    moved[i] -= 2.0 * h;
    const double below = information.cost(moved, 6.0, harmonics, 30, firmness, nullptr);
    EXPECT_NEAR(slope[i], (above - below) / (2.0 * h), 1e-4 * (1.0 + std::fabs(slope[i]))) << i;
  }
}

TEST(ArmExcitation, KeepsToEveryLimitAndToItsBox) {
  const arm::Chain::Params urdf = limited(4);
  ExcitationRequest request = request_of(4);
  request.duration_s = 10.0;
  request.share = 0.6;
  const arm::Vector3 tool(0.0, 0.0, 0.15);
  request.points = {{}, {}, {}, {tool}};
  request.box_lower_m.z() = 0.25;
  const auto found = design_excitation(names_of(4), urdf, request);
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_GT(found->worth.information_nats, 1.2 * found->random.information_nats);
  EXPECT_LT(found->worth.condition, 0.5 * found->random.condition);
  const arm::Chain chain = *arm::Chain::make(urdf);
  double lowest_m = 1e9;
  for (int i = 0; i <= 5000; ++i) {
    const FourierMotion::State state = found->motion.at(2e-3 * i);
    // What moves the bodies; what friction takes is believed, and little.
    const arm::JointVector effort = chain.inverse_dynamics(state.position, state.velocity, state.acceleration);
    for (int j = 0; j < 4; ++j) {
      EXPECT_LE(std::fabs(state.position[j]), 0.6 * 2.0);
      EXPECT_LE(std::fabs(state.velocity[j]), 0.6 * 6.0);
      EXPECT_LE(std::fabs(effort[j]), 0.6 * urdf.joints[static_cast<std::size_t>(j)].limits.effort_N_m);
    }
    const arm::LinkPose last = chain.poses(state.position)[3];
    lowest_m = std::min(lowest_m, (last.rotation * tool + last.position_m).z());
  }
  EXPECT_GE(lowest_m, 0.25);
  EXPECT_NEAR(found->clearance_m, lowest_m - 0.25, 1e-3);
}

TEST(ArmExcitation, TheSameSeedGivesTheSameMotionAndAnotherGivesAnother) {
  const auto made = [](std::uint64_t seed) {
    ExcitationRequest request = request_of(2);
    request.duration_s = 6.0;
    request.seed = seed;
    return design_excitation(names_of(2), limited(2), request)->motion.coordinates();
  };
  EXPECT_EQ(made(1), made(1));
  EXPECT_NE(made(1), made(2));
}

/// What a recording of a motion of the simulated arm tells.
struct Told {
  ArmIdentification found;
  int single = 0, held = 0, all = 0;
  std::string missed = {};
  double log_widths = 0.0;       ///< of the intervals, mean
  double worst_on_unseen = 0.0;  ///< share of a joint's effort
};

Told told_on(const FourierMotion& motion) {
  const arm::Chain::Params truth = open_arm();
  // A step asks each joint for the same three times.
  std::array<std::pair<double, arm::JointVector>, 3> asked;
  std::size_t next = 0;
  const auto path = [&](unsigned j, double t) {
    for (const auto& [time_s, position] : asked) {
      if (time_s == t && position.size() > 0) return position[j];
    }
    asked[next] = {t, motion.at(t).position};
    const double position = asked[next].second[j];
    next = (next + 1) % asked.size();
    return position;
  };
  // Fine steps: the intervals are narrower than what half of a usual one shifts.
  const ArmRecording recording = recorded_of(simulate(
      truth, {.duration_s = motion.period_s(), .seed = 1, .step_s = 1.0 / 32000.0, .steps_between = 64, .path = path}));
  auto found = identify_arm(std::array{recording}, names_of(7), limited(7));
  EXPECT_TRUE(found) << describe(found.error());
  Told told{.found = *std::move(found)};
  for (std::size_t j = 0; j < 7; ++j) {
    const arm::JointParams& joint = truth.joints[j];
    const arm::BodyVector body = arm::linear_parameters(joint.body);
    std::vector<double> values(body.begin(), body.end());
    values.insert(values.end(), {joint.drive.armature_kg_m2, joint.friction.coulomb_N_m,
                                 joint.friction.viscous_N_m_s_per_rad, joint.friction.offset_N_m});
    for (std::size_t k = 0; k < values.size(); ++k) {
      const ArmParameter& p = told.found.joints[j].parameters[k];
      told.single += p.determined ? 1 : 0;
      const bool holds = values[k] >= p.lower && values[k] <= p.upper;
      told.held += holds ? 1 : 0;
      if (!holds) told.missed += " " + told.found.joints[j].name + "." + p.name;
      told.log_widths += std::log(p.upper - p.lower);
      ++told.all;
    }
  }
  told.log_widths /= told.all;
  const ArmRecording unseen_motion = recorded_of(simulate(truth, {.seed = 5}));
  const auto unseen = estimate_external_torque(told.found.model, unseen_motion);
  for (std::size_t j = 0; j < 7; ++j) {
    const auto torque = unseen->torque_N_m.col(static_cast<Eigen::Index>(j));
    const double left = std::sqrt(torque.squaredNorm() / static_cast<double>(torque.size()));
    const Eigen::Map<const VectorXd> effort(unseen_motion.effort[j].data(),
                                            static_cast<Eigen::Index>(unseen_motion.samples()));
    const double size = std::sqrt(effort.squaredNorm() / static_cast<double>(effort.size()));
    told.worst_on_unseen = std::max(told.worst_on_unseen, left / size);
  }
  return told;
}

TEST(ArmExcitation, ARecordingOfItTellsMoreThanARandomOneOfTheSameLengthAndMostOfItsIntervalsHold) {
  ExcitationRequest request = request_of(7);
  request.duration_s = 12.0;
  const auto designed = design_excitation(names_of(7), limited(7), request);
  ASSERT_TRUE(designed) << describe(designed.error());
  const Told by_design = told_on(designed->motion);
  const Told by_chance = told_on(designed->random_motion);
  RecordProperty("single", by_design.single);
  RecordProperty("single_by_chance", by_chance.single);
  RecordProperty("held", by_design.held);
  RecordProperty("widths", std::to_string(std::exp(by_design.log_widths - by_chance.log_widths)));
  RecordProperty("unseen", std::to_string(by_design.worst_on_unseen));
  RecordProperty("unseen_by_chance", std::to_string(by_chance.worst_on_unseen));
  EXPECT_GT(by_design.found.determined_combinations, by_chance.found.determined_combinations);
  EXPECT_LT(by_design.log_widths, by_chance.log_widths);
  // One recording: its numbers share their noise, so that they are off together.
  EXPECT_GE(by_design.held, by_design.all * 17 / 20) << "not" << by_design.missed;
  EXPECT_LT(by_design.worst_on_unseen, 0.02);
  EXPECT_LT(by_design.worst_on_unseen, by_chance.worst_on_unseen);
  // What was promised before anything was recorded.
  double log_ratio = 0.0;
  int both = 0;
  for (std::size_t j = 0; j < 7; ++j) {
    for (std::size_t k = 0; k < designed->joints[j].parameters.size(); ++k) {
      const ArmParameter& promised = designed->joints[j].parameters[k];
      const ArmParameter& found = by_design.found.joints[j].parameters[k];
      if (!promised.determined || !found.determined) continue;
      log_ratio += std::log((promised.upper - promised.lower) / (found.upper - found.lower));
      ++both;
    }
  }
  RecordProperty("promised", std::to_string(std::exp(log_ratio / both)));
  EXPECT_GT(both, 50);
  EXPECT_LT(std::fabs(log_ratio / both), std::log(2.0));
}

TEST(ArmExcitation, SaysWhyThereIsNone) {
  const auto refusal = [](const std::function<void(ExcitationRequest&, arm::Chain::Params&)>& spoil) {
    arm::Chain::Params urdf = limited(3);
    ExcitationRequest request = request_of(3);
    request.points = {{}, {}, {arm::Vector3::Zero()}};
    spoil(request, urdf);
    const auto found = design_excitation(names_of(3), urdf, request);
    return found ? std::string("nothing") : describe(found.error());
  };
  const auto expect = [](const std::string& told, const std::vector<std::string>& words) {
    for (const std::string& word : words) EXPECT_NE(told.find(word), std::string::npos) << word << " in " << told;
  };
  expect(refusal([](auto&, auto& urdf) { urdf.joints[1].limits.velocity_rad_per_s = 0.0; }),
         {"'j2'", "no limit of velocity", "<limit"});
  expect(refusal([](auto&, auto& urdf) { urdf.joints[2].limits.effort_N_m = 1e9; }), {"'j3'", "no limit of effort"});
  expect(refusal([](auto& request, auto&) { request.box_lower_m.z() = 2.0; }),
         {"behind joint 'j3' is", "mm outside of the box", "widen"});
  expect(refusal([](auto&, auto& urdf) { urdf.joints[1].limits.effort_N_m = 1e-3; }), {"'j2'", "N m to hold the arm"});
  expect(refusal([](auto& request, auto&) { request.duration_s = 100.0; }), {"50 harmonics", "2 to 20"});
  expect(refusal([](auto& request, auto&) { request.noise_N_m.pop_back(); }), {"noise_N_m", "2 numbers", "3 joints"});
}

}  // namespace
}  // namespace tactus::arm_identification
