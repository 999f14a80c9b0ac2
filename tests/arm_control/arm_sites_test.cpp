// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/arm_follower.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <cmath>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/openarm.hpp"

namespace tactus::arm_control::arm_sites_test {
namespace {

constexpr Seconds tick{1e-3};

ArmLeader::Arm believed() {
  const arm_plants::ArmPlant::Params plant = arm_plants::openarm_class();
  return {.carried = plant.chain,
          .induced = {.chain = plant.chain, .tool_m = plant.tool_m},
          .gains = Joints<DriveGains>(7)};
}

ArmFollower::Arm touching_arm() { return {.chain = believed().carried, .tool_m = believed().induced.tool_m}; }

ArmReading resting() {
  return {.position = arm_plants::bent(), .velocity = JointVector::Zero(7), .torque = JointVector::Zero(7)};
}

ArmMessage touching(double torque_N_m) {
  ArmMessage message = ArmMessage::at_rest(arm_plants::bent());
  message.external_torque.setConstant(torque_N_m);
  return message;
}

TEST(ArmLeader, DisplaysTheFollowersTorqueTimesTheGainUpToTheJointsEffort) {
  auto leader = *ArmLeader::make({.method = ArmMethod::position_force, .force_gain = 2.0}, believed(), tick);
  const JointVector weight = arm::Chain::make(believed().carried)->gravity_torque(arm_plants::bent());
  const auto small = leader.step(resting(), touching(0.5));
  EXPECT_LT((small.command.torque - weight - JointVector::Ones(7)).norm(), 1e-12);
  EXPECT_EQ(small.command.stiffness.norm() + small.command.damping.norm(), 0.0);
  const auto large = leader.step(resting(), touching(50.0));
  for (int i = 0; i < 7; ++i) {
    const double limit = believed().carried.joints[static_cast<std::size_t>(i)].limits.effort_N_m;
    EXPECT_NEAR(large.command.torque[i], limit, 1e-12);
    EXPECT_NEAR(large.displayed[i], limit - weight[i], 1e-12) << "the model hears of what passed";
  }
}

TEST(ArmLeader, TakesInducedMotionFromTheCommandATickAfterTheTorqueActs) {
  auto plain = *ArmLeader::make({.method = ArmMethod::position_force}, believed(), tick);
  auto cancelling = *ArmLeader::make({.method = ArmMethod::cancellation}, believed(), tick);
  for (int k = 0; k < 20; ++k) {
    const auto told = cancelling.step(resting(), touching(1.0));
    EXPECT_EQ(plain.step(resting(), touching(1.0)).message.position, arm_plants::bent());
    EXPECT_LT((told.message.position - arm_plants::bent() + told.induced).norm(), 1e-15);
    // Commanded at tick 0, it acts from tick 1 on and has moved the arm at tick 2.
    EXPECT_EQ(told.induced.norm() > 0.0, k >= 2) << k;
  }
}

TEST(ArmLeader, ItsDamperResistsTheToolAlone) {
  auto leader = *ArmLeader::make(
      {.method = ArmMethod::position_force, .damping_N_s_per_m = 40.0, .feed_forward = {.friction_share = 0.0}},
      believed(), tick);
  const arm::Chain chain = *arm::Chain::make(believed().carried);
  ArmReading moving = resting();
  moving.velocity << 0.1, 0.2, -0.1, 0.3, 0.0, 0.1, 0.2;
  const JointVector torque = leader.step(moving, touching(0.0)).command.torque - chain.gravity_torque(moving.position);
  const auto jacobian = chain.jacobian(moving.position, 6, believed().induced.tool_m).topRows<3>().eval();
  const arm::Vector3 velocity = jacobian * moving.velocity;
  EXPECT_NEAR(torque.dot(moving.velocity), -40.0 * velocity.squaredNorm(), 1e-12);
}

TEST(ArmLeader, ItsDrivesDampTowardsRestAndTheModelCountsWithThat) {
  ArmLeader::Params params{.method = ArmMethod::cancellation};
  auto bare = *ArmLeader::make(params, believed(), tick);
  params.drive_damping.joint_1.damping_N_m_s_per_rad = 5.0;
  auto damped = *ArmLeader::make(params, believed(), tick);
  double free_rad = 0.0, damped_rad = 0.0;
  for (int k = 0; k < 50; ++k) {
    free_rad = std::fabs(bare.step(resting(), touching(1.0)).induced[0]);
    const auto output = damped.step(resting(), touching(1.0));
    damped_rad = std::fabs(output.induced[0]);
    EXPECT_EQ(output.command.damping[0], 5.0);
    EXPECT_EQ(output.command.damping.tail<6>().norm() + output.command.stiffness.norm(), 0.0);
    EXPECT_EQ(output.command.velocity.norm(), 0.0);
  }
  EXPECT_LT(damped_rad, 0.7 * free_rad);
}

TEST(ArmLeader, PositionPositionLeavesTheCouplingToTheDrives) {
  ArmLeader::Arm arm = believed();
  for (DriveGains& gains : arm.gains) gains = {.stiffness_N_m_per_rad = 240.0, .damping_N_m_s_per_rad = 3.0};
  auto leader = *ArmLeader::make({.method = ArmMethod::position_position, .force_gain = 0.5}, arm, tick);
  ArmMessage follower = touching(7.0);
  follower.position[2] += 0.1;
  follower.velocity[1] = 0.3;
  const auto output = leader.step(resting(), follower);
  EXPECT_EQ(output.command.position, follower.position);
  EXPECT_EQ(output.command.velocity, follower.velocity);
  EXPECT_EQ(output.command.stiffness, JointVector::Constant(7, 120.0));
  EXPECT_EQ(output.command.damping, JointVector::Constant(7, 1.5));
  EXPECT_EQ(output.displayed.norm(), 0.0);
}

TEST(ArmLeader, AFilteredCommandStartsWhereTheArmIs) {
  auto leader = *ArmLeader::make({.method = ArmMethod::position_force, .command_low_pass_Hz = 8.0}, believed(), tick);
  EXPECT_LT((leader.step(resting(), touching(0.0)).message.position - arm_plants::bent()).norm(), 1e-12);
  ArmReading moved = resting();
  moved.position[0] += 0.1;
  double told = 0.0;
  for (int k = 0; k < 20; ++k) told = leader.step(moved, touching(0.0)).message.position[0] - arm_plants::bent()[0];
  EXPECT_NEAR(told, 0.1 * (1.0 - std::exp(-2.0 * std::numbers::pi * 8.0 * 0.0195)), 1e-3);
}

TEST(ArmLeader, AJointsOwnLowPassIsThatJointsAlone) {
  ArmLeader::Params params{.method = ArmMethod::position_force};
  params.command_low_pass_each.joint_1.cutoff_Hz = 8.0;
  params.force_low_pass_each.joint_2.cutoff_Hz = 5.0;
  auto leader = *ArmLeader::make(params, believed(), tick);
  leader.step(resting(), touching(0.0));
  ArmReading moved = resting();
  moved.position.array() += 0.1;
  ArmLeader::Output output;
  for (int k = 0; k < 20; ++k) output = leader.step(moved, touching(1.0));
  const JointVector told = output.message.position - arm_plants::bent();
  EXPECT_NEAR(told[0], 0.1 * (1.0 - std::exp(-2.0 * std::numbers::pi * 8.0 * 0.0195)), 1e-3);
  EXPECT_LT((told.tail(6) - JointVector::Constant(6, 0.1)).norm(), 1e-12);
  const JointVector external = touching(1.0).external_torque;
  for (int i = 0; i < 7; ++i) {
    const double share = i == 1 ? 1.0 - std::exp(-2.0 * std::numbers::pi * 5.0 * 0.0195) : 1.0;
    EXPECT_NEAR(output.displayed[i], share * external[i], 1e-2 * std::fabs(external[i])) << i;
  }
}

TEST(ArmFollower, CommandsItsDrivesAndTellsTheTorqueThatItWasAskedFor) {
  ArmFollower::Params params;
  params.gains.joint_2 = {.stiffness_N_m_per_rad = 200.0, .damping_N_m_s_per_rad = 2.0};
  params.torque = TorqueSource::sensor;
  params.stiffness_share = 0.5;
  auto follower = *ArmFollower::make(params, touching_arm(), tick);
  const ArmMessage wanted = touching(0.0);
  const auto output = follower.step(resting(), JointVector::Constant(7, 0.4), wanted);
  EXPECT_EQ(output.command.stiffness[1], 100.0);
  EXPECT_EQ(output.command.damping[1], 2.0);
  EXPECT_EQ(output.command.stiffness[0], 50.0);
  EXPECT_EQ(output.command.position, wanted.position);
  EXPECT_EQ(output.message.external_torque, JointVector::Constant(7, 0.4));
  params.torque = TorqueSource::observer;
  auto observing = *ArmFollower::make(params, touching_arm(), tick);
  ArmReading held = resting();
  held.torque = arm::Chain::make(believed().carried)->gravity_torque(held.position);
  held.torque[3] -= 1.0;  // somebody lifts it
  JointVector told;
  for (int k = 0; k < 100; ++k) told = observing.step(held, JointVector::Zero(7), wanted).message.external_torque;
  EXPECT_NEAR(told[3], 1.0, 1e-6);
}

TEST(ArmFollower, TakesAwayWhatItsDrivesAreAtTheToolBeyondTheLimits) {
  ArmFollower::Params params;  // drives of 100 N m/rad and 1 N m s/rad
  auto free = *ArmFollower::make(params, touching_arm(), tick);
  params.tool_stiffness_limit_N_per_m = 300.0;
  params.tool_damping_limit_N_s_per_m = 4.0;
  auto limited = *ArmFollower::make(params, touching_arm(), tick);
  const arm::Chain chain = *arm::Chain::make(believed().carried);
  const ToolJacobian tool = chain.jacobian(arm_plants::bent(), 6, touching_arm().tool_m).topRows<3>();
  const JointVector moved = JointVector::LinSpaced(7, -0.02, 0.03);
  ArmMessage wanted = touching(0.0);
  const auto taken = [&] {
    const JointVector none = JointVector::Zero(7);
    return JointVector(free.step(resting(), none, wanted).command.torque -
                       limited.step(resting(), none, wanted).command.torque);
  };
  wanted.position += moved;
  const arm::Matrix3 stiff = ToolLimit(JointVector::Constant(7, 100.0), 300.0).excess(tool);
  EXPECT_GT(taken().norm(), 0.1);
  EXPECT_LT((taken() - tool.transpose() * (stiff * (tool * moved))).norm(), 1e-9);
  wanted.position -= moved;
  wanted.velocity = moved;
  const arm::Matrix3 damped = ToolLimit(JointVector::Constant(7, 1.0), 4.0).excess(tool);
  EXPECT_LT((taken() - tool.transpose() * (damped * (tool * moved))).norm(), 1e-9);
}

TEST(ArmFollower, TellsOnlyTorqueThatItsFrictionCannotHide) {
  ArmFollower::Arm arm = touching_arm();
  for (arm::JointParams& joint : arm.chain.joints) joint.friction.coulomb_N_m = 0.4;
  ArmFollower::Params params;
  params.observer.dead_band_share = 0.5;
  auto follower = *ArmFollower::make(params, arm, tick);
  ArmReading held = resting();
  held.torque = arm::Chain::make(arm.chain)->gravity_torque(held.position);
  held.torque[1] -= 1.0;
  held.torque[2] += 1.0;
  held.torque[3] -= 0.19;
  JointVector told;
  for (int k = 0; k < 100; ++k) told = follower.step(held, JointVector::Zero(7), touching(0.0)).message.external_torque;
  EXPECT_NEAR(told[1], 0.8, 1e-6);
  EXPECT_NEAR(told[2], -0.8, 1e-6);
  EXPECT_EQ(told[3], 0.0);
}

TEST(ArmLeader, GivesBackWhatItsDrivesDampTheToolBeyondTheLimitAndTheModelCountsWithThat) {
  ArmLeader::Params params{.method = ArmMethod::cancellation, .feed_forward = {.friction_share = 0.0}};
  for_each_field<EachJoint<DriveDamping>>(
      [&](const auto& each) { (params.drive_damping.*each.member).damping_N_m_s_per_rad = 5.0; });
  auto damped = *ArmLeader::make(params, believed(), tick);
  params.drive_damping_limit_N_s_per_m = 2.0;
  auto limited = *ArmLeader::make(params, believed(), tick);
  ArmReading moving = resting();
  moving.velocity << 0.1, 0.2, -0.1, 0.3, 0.0, 0.1, 0.2;
  const JointVector back =
      limited.step(moving, touching(0.0)).command.torque - damped.step(moving, touching(0.0)).command.torque;
  EXPECT_GT(back.dot(moving.velocity), 0.0);
  EXPECT_LT(back.dot(moving.velocity), 5.0 * moving.velocity.squaredNorm()) << "less than the drives take";
  double damped_rad = 0.0, limited_rad = 0.0;
  for (int k = 0; k < 50; ++k) {
    damped_rad = damped.step(resting(), touching(1.0)).induced.norm();
    limited_rad = limited.step(resting(), touching(1.0)).induced.norm();
  }
  EXPECT_GT(limited_rad, 1.05 * damped_rad);
}

TEST(ArmLeader, WhereAJointDoesNotDampTheToolIsFreeAndNothingIsGivenBack) {
  ArmLeader::Params params{.method = ArmMethod::position_force, .feed_forward = {.friction_share = 0.0}};
  params.drive_damping.joint_1.damping_N_m_s_per_rad = 5.0;
  params.drive_damping_limit_N_s_per_m = 2.0;
  auto leader = *ArmLeader::make(params, believed(), tick);
  ArmReading moving = resting();
  moving.velocity[0] = 0.5;
  const JointVector weight = arm::Chain::make(believed().carried)->gravity_torque(moving.position);
  EXPECT_LT((leader.step(moving, touching(0.0)).command.torque - weight).norm(), 1e-6);
}

TEST(ToolLimit, LeavesExactlyTheLimitAtTheToolAndNothingElse) {
  const arm::Chain chain = *arm::Chain::make(believed().carried);
  JointVector gains(7);
  gains << 240, 240, 240, 240, 24, 31, 25;
  constexpr double most = 600.0;
  for (const double bend : {0.0, 0.3, 0.8}) {
    JointVector pose = arm_plants::bent();
    pose[3] -= bend;
    const ToolJacobian tool = chain.jacobian(pose, 6, touching_arm().tool_m).topRows<3>();
    const arm::JointMatrix left =
        arm::JointMatrix(gains.asDiagonal()) - tool.transpose() * ToolLimit(gains, most).excess(tool) * tool;
    EXPECT_GT(signal::symmetric_eigenvalues(left)[0], 0.0);
    const auto at_tool = [&](const Eigen::MatrixXd& of_joints) {
      return signal::inverse(tool * signal::inverse(of_joints) * tool.transpose());
    };
    const auto before = signal::symmetric_eigen(at_tool(gains.asDiagonal().toDenseMatrix()));
    EXPECT_GT(before.values[2], 2.0 * most) << "the limit is reached";
    EXPECT_LT(before.values[0], most) << "and not along each axis";
    const Eigen::MatrixXd wanted =
        before.vectors * before.values.cwiseMin(most).asDiagonal() * before.vectors.transpose();
    EXPECT_LT((at_tool(left) - wanted).norm(), 1e-3 * most);
  }
}

TEST(ArmSites, ATickDoesNotAllocate) {
  ArmFollower::Params limited;
  limited.tool_stiffness_limit_N_per_m = 100.0;
  limited.tool_damping_limit_N_s_per_m = 1.0;
  limited.wanted_motion.cutoff_Hz = 6.0;
  auto leader = *ArmLeader::make({.method = ArmMethod::cancellation,
                                  .damping_N_s_per_m = 10.0,
                                  .drive_damping_limit_N_s_per_m = 5.0,
                                  .force_low_pass_Hz = 50.0,
                                  .command_low_pass_Hz = 8.0},
                                 believed(), tick);
  auto follower = *ArmFollower::make(limited, touching_arm(), tick);
  ArmMessage from_follower = touching(0.1);
  ArmReading reading = resting();
  const std::uint64_t before = laws::own_allocation_count();
  for (int k = 0; k < 50; ++k) {
    reading.velocity.setConstant(0.01 * k);
    const auto told = leader.step(reading, from_follower);
    from_follower = follower.step(reading, JointVector::Zero(7), told.message).message;
  }
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_TRUE(from_follower.external_torque.allFinite());
}

TEST(ArmSites, ATickWithDampersWashedOutAndABiasByTravelDoesNotAllocate) {
  auto leader = *ArmLeader::make({.method = ArmMethod::cancellation,
                                  .damping_N_s_per_m = 10.0,
                                  .drive_damping_limit_N_s_per_m = 5.0,
                                  .damping_washout_Hz = 3.0},
                                 believed(), tick);
  ArmFollower::Params params{.torque = TorqueSource::observer};
  params.observer.bias_distance_m = 0.3;
  auto follower = *ArmFollower::make(params, touching_arm(), tick);
  ArmReading reading = resting();
  reading.torque = arm::Chain::make(believed().carried)->gravity_torque(arm_plants::bent());
  ArmMessage from_follower = touching(0.0);
  const std::uint64_t before = laws::own_allocation_count();
  for (int k = 0; k < 100; ++k) {
    reading.velocity.setConstant(0.01 * k);
    from_follower = k < 50 ? touching(k < 25 ? 0.0 : 5.0) : from_follower;
    const auto told = leader.step(reading, from_follower);
    from_follower = follower.step(reading, JointVector::Zero(7), told.message).message;
  }
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_TRUE(from_follower.external_torque.allFinite());
}

TEST(ArmLeader, WithDampersWashedOutSlowMotionIsFreeAndFastMotionIsDampedAsBefore) {
  ArmLeader::Params params{.method = ArmMethod::position_force, .feed_forward = {.friction_share = 0.0}};
  params.damping_N_s_per_m = 40.0;
  params.drive_damping.joint_1.damping_N_m_s_per_rad = 5.0;
  auto damped = *ArmLeader::make(params, believed(), tick);
  params.damping_washout_Hz = 3.0;
  auto washed = *ArmLeader::make(params, believed(), tick);
  const JointVector weight = arm::Chain::make(believed().carried)->gravity_torque(arm_plants::bent());
  ArmReading moving = resting();
  // The drives' own dampers are in the command, towards rest; the rest is torque over the bus.
  const auto resists = [&](ArmLeader& leader) -> JointVector {
    const auto command = leader.step(moving, touching(0.0)).command;
    return weight - command.torque + command.damping.cwiseProduct(moving.velocity);
  };
  moving.velocity << 0.1, 0.2, -0.1, 0.3, 0.0, 0.1, 0.2;
  const JointVector at_once = resists(washed), always = resists(damped);
  EXPECT_LT((at_once - always).norm(), 0.03 * always.norm());
  for (int k = 0; k < 2000; ++k) resists(washed);
  EXPECT_LT(resists(washed).norm(), 1e-6 * always.norm());
}

TEST(ArmSites, RefuseNumbersOutOfBoundsByName) {
  EXPECT_EQ(ArmLeader::make({.force_gain = -1.0}, believed(), tick).error().parameter, "force_gain");
  EXPECT_EQ(ArmLeader::make({.command_low_pass_Hz = 300.0}, believed(), Seconds{2e-3}).error().parameter,
            "command_low_pass_Hz");
  ArmLeader::Params own;
  own.force_low_pass_each.joint_2.cutoff_Hz = 500.0;
  EXPECT_EQ(ArmLeader::make(own, believed(), tick).error().parameter, "force_low_pass_each.joint_2.cutoff_Hz");
  ArmLeader::Params params;
  params.model.hand.mass_kg = 50.0;
  EXPECT_EQ(ArmLeader::make(params, believed(), tick).error().parameter, "model.hand.mass_kg");
  ArmFollower::Params follower;
  follower.observer.cutoff_Hz = 700.0;
  EXPECT_EQ(ArmFollower::make(follower, touching_arm(), tick).error().parameter, "observer.cutoff_Hz");
  ArmFollower::Params wanted;
  wanted.wanted_motion.cutoff_Hz = 60.0;
  EXPECT_EQ(ArmFollower::make(wanted, touching_arm(), tick).error().parameter, "wanted_motion.cutoff_Hz");
  wanted.observer.cutoff_Hz = 20.0;
  wanted.wanted_motion.cutoff_Hz = 30.0;
  EXPECT_EQ(ArmFollower::make(wanted, touching_arm(), Seconds{0.02}).error().parameter, "wanted_motion.cutoff_Hz");
}

}  // namespace
}  // namespace tactus::arm_control::arm_sites_test
