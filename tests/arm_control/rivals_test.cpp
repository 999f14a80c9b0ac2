// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/arm_follower.hpp>
#include <tactus/kernel/arm_control/arm_leader.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/openarm.hpp"

// The laws of others, against what their sources compute.
namespace tactus::arm_control::rivals_test {
namespace {

constexpr Seconds tick{1e-3};

arm::Chain::Params yam_class() {
  const auto read = urdf::read(std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/yam-class.urdf");
  if (!read) throw std::runtime_error(describe(read.error()));
  return read->params;
}

ArmReading at(const JointVector& position) {
  const JointVector none = JointVector::Zero(position.size());
  return {.position = position, .velocity = none, .torque = none};
}

JointVector drawn(Eigen::Index joints, double most, signal::Random& random) {
  JointVector vector(joints);
  for (double& each : vector) each = random.uniform(-most, most);
  return vector;
}

ArmLeader leader_with(ArmMethod method, double gain) {
  const arm_plants::ArmPlant::Params plant = arm_plants::openarm_class();
  return *ArmLeader::make({.method = method, .force_gain = gain, .feed_forward = {.friction_share = 0.0}},
                          {.carried = plant.chain, .induced = {.chain = plant.chain, .tool_m = plant.tool_m}}, tick);
}

ArmMessage touching(const JointVector& torque) {
  ArmMessage message = ArmMessage::at_rest(arm_plants::bent());
  message.external_torque = torque;
  return message;
}

JointVector weight(const JointVector& position) {
  return arm::Chain::make(arm_plants::openarm_class().chain)->gravity_torque(position);
}

TEST(FeedbackAvoidance, IsTheReleasedLawInItsOwnSigns) {
  constexpr double alpha[] = {18.75, 15, 13.5, 9, 5.25, 3, 1.5};
  const FeedbackAvoidance avoidance(FeedbackAvoidance::released, 7);
  signal::Random random(3);
  int along = 0;
  for (int draw = 0; draw < 200; ++draw) {
    const JointVector velocity = drawn(7, 0.5, random);
    const JointVector reflected = drawn(7, 5.0, random);
    const JointVector displayed = avoidance.displayed(reflected, velocity);
    for (int i = 0; i < 7; ++i) {
      const double tau_in = -reflected[i];
      const double power_in = velocity[i] * tau_in;
      const int sign = (velocity[i] > 0.0) - (velocity[i] < 0.0);
      const double term = power_in < 0.0 ? -alpha[i] * sign * std::fabs(power_in) : 0.0;
      along += power_in < 0.0 ? 1 : 0;
      EXPECT_NEAR(displayed[i], -tau_in + term, 1e-12);
    }
  }
  EXPECT_GT(along, 400);
}

TEST(FeedbackAvoidance, LeavesAPushWholeAndTakesTheThrowAway) {
  auto leader = leader_with(ArmMethod::feedback_avoidance, 2.0);
  const JointVector torque = JointVector::Constant(7, 0.5);
  ArmReading moving = at(arm_plants::bent());
  EXPECT_LT((leader.step(moving, touching(torque)).displayed - 2.0 * torque).norm(), 1e-12) << "at rest";
  moving.velocity.setConstant(-0.2);
  EXPECT_LT((leader.step(moving, touching(torque)).displayed - 2.0 * torque).norm(), 1e-12) << "pushing into it";
  moving.velocity.setZero();
  moving.velocity[0] = 1.0 / 18.75;
  moving.velocity[1] = 2.0 / 15.0;
  const auto thrown = leader.step(moving, touching(torque));
  EXPECT_NEAR(thrown.displayed[0], 0.0, 1e-12) << "gone";
  EXPECT_NEAR(thrown.displayed[1], -1.0, 1e-12) << "a brake";
  EXPECT_NEAR(thrown.displayed[2], 1.0, 1e-12) << "each joint by itself";
  EXPECT_EQ(thrown.message.position, moving.position);
}

TEST(FactrLaw, DisplaysTheShareAndAnswersAStepAtOnce) {
  constexpr double released = 3.0 / 94.5652173913;
  auto leader = leader_with(ArmMethod::factr, released);
  const JointVector torque = JointVector::LinSpaced(7, -2.0, 3.0);
  EXPECT_EQ(leader.step(at(arm_plants::bent()), touching(JointVector::Zero(7))).displayed.norm(), 0.0);
  const auto output = leader.step(at(arm_plants::bent()), touching(torque));
  EXPECT_LT((output.displayed - released * torque).norm(), 1e-12);
  EXPECT_EQ(output.message.position, arm_plants::bent());
}

TEST(FactrLaw, DithersWhatRestsByAShareOfItsWeightUpAndDownInTurn) {
  auto leader = leader_with(ArmMethod::factr, 0.0);
  const JointVector carried = weight(arm_plants::bent());
  ArmReading reading = at(arm_plants::bent());
  for (int k = 0; k < 6; ++k) {
    const JointVector beside = leader.step(reading, touching(JointVector::Zero(7))).command.torque - carried;
    EXPECT_LT((beside - (k % 2 == 0 ? 0.6 : -0.6) * carried.cwiseAbs()).norm(), 1e-12) << k;
  }
  reading.velocity[3] = 0.91;
  const arm::Chain chain = *arm::Chain::make(arm_plants::openarm_class().chain);
  const JointVector beside = leader.step(reading, touching(JointVector::Zero(7))).command.torque -
                             chain.bias(reading.position, reading.velocity);
  EXPECT_NEAR(beside[3], 0.0, 0.02) << "but for the null space's damper";
  EXPECT_NEAR(beside[1], 0.6 * std::fabs(carried[1]), 0.05) << "the others go on";
}

FactrLaw::Params of_null_space(double stiffness, double damping) {
  FactrLaw::Params params{.dither_share = 0.0};
  params.null_space_stiffness_N_m_per_rad = stiffness;
  params.null_space_damping_N_m_s_per_rad = damping;
  return params;
}

TEST(FactrLaw, SevenJointsAreHeldWhereThatDoesNotMoveTheTool) {
  const arm::Chain::Params arm = arm_plants::openarm_class().chain;
  const arm::Chain chain = *arm::Chain::make(arm);
  FactrLaw law(of_null_space(2.0, 0.0), arm, chain);
  EXPECT_LT(law.step(at(arm_plants::bent())).norm(), 1e-12) << "at its target";
  const JointVector moved = JointVector::LinSpaced(7, -0.1, 0.2);
  const ArmReading reading = at(arm_plants::bent() + moved);
  const JointVector torque = law.step(reading);
  const Eigen::MatrixXd tool = chain.jacobian(reading.position, 6, arm::Vector3::Zero());
  const Eigen::MatrixXd pseudo = tool.transpose() * signal::inverse(tool * tool.transpose());
  const Eigen::VectorXd wanted = -2.0 * (Eigen::MatrixXd::Identity(7, 7) - pseudo * tool) * moved;
  EXPECT_LT((torque - wanted).norm(), 1e-9);
  EXPECT_GT(torque.norm(), 0.01);
  EXPECT_LT((tool * torque).norm(), 1e-9);
  EXPECT_LT(torque.dot(moved), 0.0) << "back";
}

TEST(FactrLaw, SixJointsHaveNoNullSpaceUnlessTheyAreSingular) {
  const arm::Chain::Params arm = yam_class();
  const arm::Chain chain = *arm::Chain::make(arm);
  JointVector pose(6);
  pose << 0.2, 1.2, 1.2, 0.1, 0.1, 0.2;
  FactrLaw law(of_null_space(2.0, 0.5), arm, chain);
  law.step(at(pose));
  ArmReading moving = at(pose + JointVector::Constant(6, 0.05));
  moving.velocity.setConstant(0.1);
  const JointVector coriolis = chain.bias(moving.position, moving.velocity) - chain.gravity_torque(moving.position);
  EXPECT_LT((law.step(moving) - coriolis).norm(), 1e-9);
  // Two axes in line: turning them against each other moves nothing.
  arm::Chain::Params doubled = arm;
  doubled.joints[1] = doubled.joints[0];
  doubled.joints[1].origin = {};
  const arm::Chain singular = *arm::Chain::make(doubled);
  FactrLaw held(of_null_space(2.0, 0.0), doubled, singular);
  held.step(at(pose));
  moving = at(pose);
  moving.position[0] += 0.1;
  moving.position[1] -= 0.1;
  const JointVector torque = held.step(moving);
  EXPECT_NEAR(torque[0], -0.2, 1e-9);
  EXPECT_NEAR(torque[1], 0.2, 1e-9);
}

TEST(FactrLaw, PushesBackWithinTheMarginOfALimitAlone) {
  arm::Chain::Params arm = arm_plants::openarm_class().chain;
  const JointVector pose = arm_plants::bent();
  arm.joints[3].limits.upper_rad = pose[3] + 0.05;   // 0.05 rad within the margin
  arm.joints[4].limits.lower_rad = pose[4] - 0.02;   // 0.08 rad
  arm.joints[5].limits.upper_rad = pose[5] + 0.101;  // before it
  FactrLaw law(of_null_space(0.0, 0.0), arm, *arm::Chain::make(arm));
  JointVector torque = law.step(at(pose));
  EXPECT_NEAR(torque[3], -1.03561658022 * 0.05, 1e-12);
  EXPECT_NEAR(torque[4], 1.03561658022 * 0.08, 1e-12);
  torque[3] = torque[4] = 0.0;
  EXPECT_EQ(torque.norm(), 0.0);
}

TEST(FactrLaw, DampsEachJointWhereItIsToldTo) {
  const arm::Chain::Params arm = arm_plants::openarm_class().chain;
  const arm::Chain chain = *arm::Chain::make(arm);
  FactrLaw::Params params = of_null_space(0.0, 0.0);
  params.damping_N_m_s_per_rad = 0.3;
  FactrLaw law(params, arm, chain);
  ArmReading moving = at(arm_plants::bent());
  moving.velocity = JointVector::LinSpaced(7, -1.0, 1.0);
  const JointVector coriolis = chain.bias(moving.position, moving.velocity) - chain.gravity_torque(moving.position);
  EXPECT_LT((law.step(moving) - coriolis + 0.3 * moving.velocity).norm(), 1e-12);
}

/// The released tick in its own words, for one joint: a reaction is what the arm presses with.
struct ReleasedJoint {
  double kp, kd, g, kf, limit;
  double reaction = 0.0, disturbance = 0.0, dob = 0.0, rfob = 0.0;
  /// Returns what is sent as feed-forward, less gravity. A reference is position, velocity and reaction of the other
  /// arm, a response position and velocity of this one.
  double step(double oblique, double j, double friction_and_coriolis, const std::array<double, 3>& reference,
              const std::array<double, 2>& response) {
    const double ts = tick.value;
    const double tau_p = kp * (reference[0] - response[0]);
    const double tau_v = kd * (reference[1] - response[1]);
    const double tau_f = -oblique * kf * (reference[2] + reaction);
    const double joint_torque = tau_p + tau_v + tau_f + disturbance;
    dob += g * ts * (joint_torque + g * j * response[1] - dob);
    disturbance = std::clamp(dob - response[1] * j * g, -limit, limit);
    rfob += g * ts * (joint_torque + g * j * response[1] - friction_and_coriolis - rfob);
    reaction = rfob - response[1] * j * g;
    return joint_torque - tau_p - tau_v;
  }
};

TEST(FourChannel, IsTheReleasedTickInItsOwnWordsOnBothSides) {
  const std::vector<ReleasedJoint> released{{250, 3.5, 15, 1.5, 11.5}, {220, 3, 15, 1.5, 11.5}, {250, 4, 18, 1.5, 10.5},
                                            {250, 4, 24, 2.7, 11.5},   {25, 0.3, 15, 1, 7},     {28, 0.17, 16, 0.8, 7},
                                            {31, 0.3, 15.8, 1, 6}};
  arm::Chain::Params arm = arm_plants::openarm_class().chain;
  for (arm::JointParams& joint : arm.joints) {
    joint.friction.coulomb_N_m = 0.3;
    joint.friction.viscous_N_m_s_per_rad = 0.1;
  }
  const arm::Chain chain = *arm::Chain::make(arm);
  const FeedForward carried({.friction_share = 1.0}, arm, chain);
  for (const bool leads : {true, false}) {
    FourChannel law({}, leads ? FourChannel::Side::leader : FourChannel::Side::follower, 1.0, arm, chain, tick);
    std::vector<ReleasedJoint> joints = released;
    signal::Random random(5);
    bool limited = false;
    for (int k = 0; k < 300; ++k) {
      ArmReading reading = at(arm_plants::bent() + drawn(7, 0.1, random));
      reading.velocity = drawn(7, 0.5, random);
      ArmMessage other = touching(drawn(7, 5.0, random));
      other.position += JointVector::Constant(7, 0.03) + drawn(7, 0.1, random);
      other.velocity = drawn(7, 0.5, random);
      const auto output = law.step(reading, other);
      const JointVector own = chain.mass_matrix(reading.position).diagonal();
      const JointVector others = chain.mass_matrix(other.position).diagonal();
      const JointVector unmodelled = carried.torque(reading) + chain.bias(reading.position, reading.velocity) -
                                     2.0 * chain.gravity_torque(reading.position);
      for (Eigen::Index i = 0; i < 7; ++i) {
        const double l = leads ? own[i] : others[i], f = leads ? others[i] : own[i];
        ReleasedJoint& joint = joints[static_cast<std::size_t>(i)];
        const double sent = joint.step((leads ? l : f) / (l + 0.8 * f), own[i], unmodelled[i],
                                       {other.position[i], other.velocity[i], -other.external_torque[i]},
                                       {reading.position[i], reading.velocity[i]});
        ASSERT_NEAR(output.torque[i], sent, 1e-9) << k << " " << i;
        ASSERT_NEAR(output.external[i], -joint.reaction, 1e-9) << k << " " << i;
        limited = limited || std::fabs(joint.disturbance) == joint.limit;
      }
    }
    EXPECT_TRUE(limited);
  }
}

/// A turntable of 0.1 kg m² about an upright axis.
arm::Chain::Params turntable() {
  arm::Chain::Params arm{.joints = Joints<arm::JointParams>(1)};
  arm.joints[0].body = {.mass_kg = 1.0, .xx_kg_m2 = 0.1, .yy_kg_m2 = 0.1, .zz_kg_m2 = 0.1};
  return arm;
}

/// A turntable as it moves, by Euler's rule, with the law of its drive.
struct Turning {
  double position_rad = 0.0, velocity_rad_per_s = 0.0;
  void move(const FourChannel& law, const FourChannel::Output& sent, const ArmMessage& other, double external_N_m) {
    const double drive_N_m = law.stiffness()[0] * (other.position[0] - position_rad) +
                             law.damping()[0] * (other.velocity[0] - velocity_rad_per_s);
    velocity_rad_per_s += 1e-4 * (drive_N_m + sent.torque[0] + external_N_m) / 0.1;
    position_rad += 1e-4 * velocity_rad_per_s;
  }
  [[nodiscard]] ArmReading reading() const {
    return {.position = JointVector::Constant(1, position_rad),
            .velocity = JointVector::Constant(1, velocity_rad_per_s),
            .torque = JointVector::Zero(1)};
  }
  [[nodiscard]] ArmMessage message(const JointVector& external) const {
    return {.position = reading().position, .velocity = reading().velocity, .external_torque = external};
  }
};

TEST(FourChannel, InTheEndPositionsAreEqualAndTorquesBalanceAtTheGain) {
  const arm::Chain::Params arm = turntable();
  const arm::Chain chain = *arm::Chain::make(arm);
  for (const double gain : {0.5, 1.0, 2.0}) {
    FourChannel leads({}, FourChannel::Side::leader, gain, arm, chain, tick);
    FourChannel follows({}, FourChannel::Side::follower, gain, arm, chain, tick);
    Turning leader, follower;
    ArmMessage of_leader = leader.message(JointVector::Zero(1)), of_follower = of_leader;
    double wall_N_m = 0.0;
    for (int k = 0; k < 8000; ++k) {
      const auto to_leader = leads.step(leader.reading(), of_follower);
      const auto to_follower = follows.step(follower.reading(), of_leader);
      const ArmMessage heard_by_leader = of_follower, heard_by_follower = of_leader;
      of_leader = leader.message(to_leader.external);
      of_follower = follower.message(to_follower.external);
      for (int i = 0; i < 10; ++i) {
        wall_N_m = -40.0 * follower.position_rad - 0.5 * follower.velocity_rad_per_s;
        leader.move(leads, to_leader, heard_by_leader, 1.0 - 0.5 * leader.velocity_rad_per_s);
        follower.move(follows, to_follower, heard_by_follower, wall_N_m);
      }
    }
    EXPECT_NEAR(wall_N_m, -1.0 / gain, 1e-3);
    EXPECT_NEAR(leader.position_rad, follower.position_rad, 1e-5);
    EXPECT_NEAR(of_leader.external_torque[0], 1.0, 1e-3) << "what the hand does";
    EXPECT_NEAR(of_follower.external_torque[0], wall_N_m, 1e-3);
  }
}

TEST(FourChannel, TheSitesSendWhatTheLawAddsAndTheDrivesDoTheRest) {
  const arm::Chain::Params arm = arm_plants::openarm_class().chain;
  const arm::Chain chain = *arm::Chain::make(arm);
  auto leader = leader_with(ArmMethod::four_channel, 2.0);
  ArmFollower::Params params;
  params.feed_forward.friction_share = 0.0;
  auto follower = *ArmFollower::make(params, {.chain = arm, .four_channel = FourChannelCoupling{.gain = 2.0}}, tick);
  FourChannel leads({}, FourChannel::Side::leader, 2.0, arm, chain, tick);
  FourChannel follows({}, FourChannel::Side::follower, 2.0, arm, chain, tick);
  ArmMessage told = touching(JointVector::Constant(7, 0.5));
  told.position[1] += 0.01;
  told.velocity[2] = 0.1;
  const ArmReading reading = at(arm_plants::bent());
  for (int k = 0; k < 5; ++k) {
    const auto of_leader = leader.step(reading, told);
    const auto of_follower = follower.step(reading, JointVector::Zero(7), told);
    const auto to_leader = leads.step(reading, told), to_follower = follows.step(reading, told);
    EXPECT_LT((of_leader.command.torque - weight(reading.position) - to_leader.torque).norm(), 1e-9);
    EXPECT_LT((of_follower.command.torque - weight(reading.position) - to_follower.torque).norm(), 1e-9);
    EXPECT_EQ(of_leader.message.external_torque, to_leader.external);
    EXPECT_EQ(of_follower.message.external_torque, to_follower.external);
    for (const ArmCommand& command : {of_leader.command, of_follower.command}) {
      EXPECT_EQ(command.stiffness, leads.stiffness());
      EXPECT_EQ(command.damping, leads.damping());
      EXPECT_EQ(command.position, told.position);
      EXPECT_EQ(command.velocity, told.velocity);
    }
  }
}

TEST(Rivals, ATickDoesNotAllocate) {
  auto factr = leader_with(ArmMethod::factr, 1.0);
  auto avoiding = leader_with(ArmMethod::feedback_avoidance, 1.0);
  auto both_ways = leader_with(ArmMethod::four_channel, 1.0);
  ArmReading reading = at(arm_plants::bent());
  const ArmMessage told = touching(JointVector::Ones(7));
  double sum = 0.0;
  const std::uint64_t before = laws::own_allocation_count();
  for (int k = 0; k < 50; ++k) {
    reading.velocity.setConstant(0.02 * k);
    sum += factr.step(reading, told).command.torque.sum() + avoiding.step(reading, told).command.torque.sum();
    sum += both_ways.step(reading, told).command.torque.sum();
  }
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace tactus::arm_control::rivals_test
