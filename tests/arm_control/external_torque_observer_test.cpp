// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/external_torque_observer.hpp>

#include <cmath>
#include <numbers>

#include "tests/arm_plants/openarm.hpp"

namespace tactus::arm_control::external_torque_observer_test {
namespace {

constexpr double tick_s = 1e-3;
constexpr double cutoff_Hz = 30.0;

double answered(double time_s) { return 1.0 - std::exp(-2.0 * std::numbers::pi * cutoff_Hz * time_s); }

TEST(ExternalTorqueObserver, AnswersAStepOnAnArmAtRestAsFirstOrder) {
  const arm::Chain chain = *arm::Chain::make(arm_plants::openarm_class().chain);
  auto observer = *ExternalTorqueObserver::make({.cutoff_Hz = cutoff_Hz}, chain, Seconds{tick_s});
  const JointVector q = arm_plants::bent();
  JointVector external(7);
  external << 1.0, -2.0, 0.5, 0.3, 0.1, -0.2, 0.05;
  const JointVector none = JointVector::Zero(7);
  const JointVector weight = chain.gravity_torque(q);
  for (int k = 0; k < 5; ++k) EXPECT_LT(observer.step({q, none, weight}).norm(), 1e-12);
  // The motors hold against it at once, so that the mean of the first tick is half of it.
  JointVector found = observer.step({q, none, weight - external});
  const double first = 0.5 * answered(tick_s);
  EXPECT_LT((found - first * external).norm(), 1e-12);
  for (int k = 1; k <= 60; ++k) {
    found = observer.step({q, none, weight - external});
    const double share = 1.0 - (1.0 - first) * (1.0 - answered(k * tick_s));
    EXPECT_LT((found - share * external).norm(), 1e-12) << k;
  }
}

TEST(ExternalTorqueObserver, OnAMovingArmItAnswersAStepOfForceByItsClosedForm) {
  arm_plants::ArmPlant::Params params = arm_plants::openarm_class();
  for (arm::JointParams& joint : params.chain.joints) joint.friction.viscous_N_m_s_per_rad = 0.3;
  arm_plants::ArmPlant arm = *arm_plants::ArmPlant::make(params, arm_plants::bent());
  const arm::Chain chain = *arm::Chain::make(params.chain);
  auto observer = *ExternalTorqueObserver::make({.cutoff_Hz = cutoff_Hz}, chain, Seconds{tick_s});
  const auto run = [&](const arm_plants::ToolForce& force, int k) {
    // It falls and swings: all terms of its motion are there.
    ArmCommand command = ArmCommand::of_torque(0.7 * chain.gravity_torque(arm.read().position));
    command.torque[0] += 2.0 * std::sin(0.05 * k);
    arm.write(command);
    const JointVector found = observer.step(arm.read());
    for (int i = 0; i < 10; ++i) arm.step(force);
    return found;
  };
  double most = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double found = run({}, k).cwiseAbs().maxCoeff();
    if (k > 50) most = std::max(most, found);  // the drives told no torque before the first step
  }
  ASSERT_GT(arm.link_velocity().norm(), 0.5);
  EXPECT_LT(most, 0.05) << "N m in free motion";
  const arm_plants::ToolForce force{.force_N = arm::Vector3(3.0, -2.0, 8.0)};
  for (int k = 0; k < 80; ++k) {
    const JointVector external = arm.torque_of(force);
    const JointVector found = run(force, 200 + k);
    EXPECT_LT((found - answered(k * tick_s) * external).norm(), 0.03 * external.norm()) << k;
  }
}

TEST(ExternalTorqueObserver, NoiseOfTheVelocitysStepIsAboutWhatItsFormulaSays) {
  const arm::Chain chain = *arm::Chain::make(arm_plants::openarm_class().chain);
  auto observer = *ExternalTorqueObserver::make({.cutoff_Hz = cutoff_Hz}, chain, Seconds{tick_s});
  const JointVector q = arm_plants::bent();
  const double step = 90.0 / 4095.0;
  JointVector v = JointVector::Zero(7);
  observer.step({q, v, chain.gravity_torque(q)});
  v[0] = step;
  const double found = observer.step({q, v, chain.gravity_torque(q)})[0];
  EXPECT_NEAR(found, chain.mass_matrix(q)(0, 0) * step * 2.0 * std::numbers::pi * cutoff_Hz, 0.1 * found);
}

TEST(ExternalTorqueObserver, AJointsOwnCornerIsThatJointsAlone) {
  const arm::Chain chain = *arm::Chain::make(arm_plants::openarm_class().chain);
  ExternalTorqueObserver::Params own{.cutoff_Hz = cutoff_Hz};
  own.cutoff_each.joint_5.cutoff_Hz = 80.0;
  ExternalTorqueObserver all = *ExternalTorqueObserver::make({.cutoff_Hz = cutoff_Hz}, chain, Seconds{tick_s});
  ExternalTorqueObserver other = *ExternalTorqueObserver::make({.cutoff_Hz = 80.0}, chain, Seconds{tick_s});
  ExternalTorqueObserver mixed = *ExternalTorqueObserver::make(own, chain, Seconds{tick_s});
  JointVector q = arm_plants::bent(), v = JointVector::Zero(7);
  for (int k = 0; k < 100; ++k) {
    v += JointVector::LinSpaced(7, -0.02, 0.01) * std::cos(0.1 * k);
    q += tick_s * v;
    const ArmReading reading{q, v, JointVector::LinSpaced(7, -3.0, 3.0)};
    JointVector expected = all.step(reading);
    expected[4] = other.step(reading)[4];
    ASSERT_EQ(mixed.step(reading), expected) << k;
  }
}

TEST(ExternalTorqueObserver, RefusesACutoffThatTheTickCannotHave) {
  const arm::Chain chain = *arm::Chain::make(arm_plants::openarm_class().chain);
  EXPECT_EQ(ExternalTorqueObserver::make({.cutoff_Hz = 600.0}, chain, Seconds{tick_s}).error().parameter, "cutoff_Hz");
  ExternalTorqueObserver::Params own;
  own.cutoff_each.joint_3.cutoff_Hz = 500.0;
  EXPECT_EQ(ExternalTorqueObserver::make(own, chain, Seconds{tick_s}).error().parameter,
            "cutoff_each.joint_3.cutoff_Hz");
  own.cutoff_each.joint_3.cutoff_Hz = -1.0;
  EXPECT_EQ(ExternalTorqueObserver::make(own, chain, Seconds{tick_s}).error().parameter,
            "cutoff_each.joint_3.cutoff_Hz");
}

}  // namespace
}  // namespace tactus::arm_control::external_torque_observer_test
