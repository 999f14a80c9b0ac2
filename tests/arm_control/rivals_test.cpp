#include <tactus/arm_control/arm_leader.hpp>
#include <tactus/signal/decompositions.hpp>
#include <tactus/signal/random.hpp>

#include <cmath>
#include <stdexcept>
#include <string>

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

TEST(Rivals, ATickDoesNotAllocate) {
  auto factr = leader_with(ArmMethod::factr, 1.0);
  auto avoiding = leader_with(ArmMethod::feedback_avoidance, 1.0);
  ArmReading reading = at(arm_plants::bent());
  const ArmMessage told = touching(JointVector::Ones(7));
  double sum = 0.0;
  const std::uint64_t before = laws::own_allocation_count();
  for (int k = 0; k < 50; ++k) {
    reading.velocity.setConstant(0.02 * k);
    sum += factr.step(reading, told).command.torque.sum() + avoiding.step(reading, told).command.torque.sum();
  }
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace tactus::arm_control::rivals_test
