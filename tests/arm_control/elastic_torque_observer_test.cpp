// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/elastic_torque_observer.hpp>

#include <cmath>
#include <numbers>

#include "tests/arm_plants/openarm.hpp"

namespace tactus::arm_control::elastic_torque_observer_test {
namespace {

constexpr double tick_s = 1e-3;
constexpr double cutoff_Hz = 20.0;
constexpr double stiffness_N_m_per_rad = 600.0;

/// The step response of a Butterworth low-pass of third order, 1/((s + 1)(s² + s + 1)) in units of its corner.
double answered(double time_s, double corner_Hz = cutoff_Hz) {
  const double t = 2.0 * std::numbers::pi * corner_Hz * time_s;
  const double swing = 0.5 * std::numbers::sqrt3 * t;
  return 1.0 - std::exp(-t) - 2.0 / std::numbers::sqrt3 * std::exp(-0.5 * t) * std::sin(swing);
}

TEST(ElasticTorqueObserver, AnswersAStepOnAnArmAtRestInThirdOrder) {
  const arm::Chain::Params params = arm_plants::openarm_class().chain;
  auto observer =
      *ElasticTorqueObserver::make({.cutoff_Hz = cutoff_Hz}, params, JointVector::Constant(7, 1e12), Seconds{tick_s});
  const JointVector q = arm_plants::bent();
  const JointVector none = JointVector::Zero(7);
  const JointVector external = JointVector::LinSpaced(7, -1.0, 2.0);
  const JointVector weight = arm::Chain::make(params)->gravity_torque(q);
  for (int k = 0; k < 5; ++k) EXPECT_LT(observer.step({q, none, weight}).norm(), 1e-9);
  for (int k = 0; k <= 100; ++k) {
    // The mean of the first tick is half of the step, which so stands half a tick before its reading.
    const JointVector found = observer.step({q, none, weight - external});
    EXPECT_LT((found - answered((k + 0.5) * tick_s) * external).norm(), 1e-3 * external.norm()) << k;
  }
}

TEST(ElasticTorqueObserver, ADriveThatTellsNoTorqueBeforeItsFirstCommandIsNotTheArmsWeightFromOutside) {
  const arm::Chain::Params params = arm_plants::openarm_class().chain;
  auto observer =
      *ElasticTorqueObserver::make({.cutoff_Hz = cutoff_Hz}, params, JointVector::Constant(7, 3000.0), Seconds{tick_s});
  const JointVector q = arm_plants::bent();
  const JointVector none = JointVector::Zero(7);
  const JointVector weight = arm::Chain::make(params)->gravity_torque(q);
  ASSERT_GT(weight.norm(), 3.0);
  double most_N_m = observer.step({q, none, none}).norm();
  for (int k = 0; k < 200; ++k) most_N_m = std::max(most_N_m, observer.step({q, none, weight}).norm());
  EXPECT_LT(most_N_m, 0.15 * weight.norm());
}

TEST(ElasticTorqueObserver, TellsAForceOnSwingingLinksWhereTheRigidObserverTellsTheirSwing) {
  arm_plants::ArmPlant::Params params = arm_plants::openarm_class();
  for (arm::JointParams& joint : params.chain.joints) joint.friction.viscous_N_m_s_per_rad = 0.1;
  for (arm_plants::MotorParams& motor : params.motors) motor.joint_stiffness_N_m_per_rad = stiffness_N_m_per_rad;
  arm_plants::ArmPlant arm = *arm_plants::ArmPlant::make(params, arm_plants::bent());
  const arm::Chain chain = *arm::Chain::make(params.chain);
  constexpr double own_Hz = 12.0;  // of a joint that the force loads
  ElasticTorqueObserver::Params corners{.cutoff_Hz = cutoff_Hz};
  corners.cutoff_each.joint_2.cutoff_Hz = own_Hz;
  auto elastic = *ElasticTorqueObserver::make(corners, params.chain, JointVector::Constant(7, stiffness_N_m_per_rad),
                                              Seconds{tick_s});
  auto rigid = *ExternalTorqueObserver::make({.cutoff_Hz = cutoff_Hz}, chain, Seconds{tick_s});
  const arm_plants::ToolForce force{.force_N = arm::Vector3(0.0, 2.0, 8.0)};
  const JointVector start = arm_plants::bent();
  JointVector stiffness(7), damping(7);
  stiffness << 240.0, 240.0, 240.0, 240.0, 24.0, 31.0, 25.0;
  damping << 3.0, 3.0, 3.0, 3.0, 0.2, 0.2, 0.2;
  double off_elastic = 0.0, off_rigid = 0.0, most_of_own = 0.0;
  for (int k = -300; k < 150; ++k) {
    const ArmReading reading = arm.read();
    const JointVector external = arm.torque_of(force);
    const double share = k < 0 ? 0.0 : answered((k - 0.5) * tick_s);
    JointVector expected = share * external;
    const JointVector by_elastic = elastic.step(reading), by_rigid = rigid.step(reading);
    if (k > -50) {  // the drives told no torque before the first step
      off_rigid = std::max(off_rigid, (by_rigid - expected).norm() / external.norm());
      if (k >= 0) expected[1] = answered((k - 0.5) * tick_s, own_Hz) * external[1];
      off_elastic = std::max(off_elastic, (by_elastic - expected).norm() / external.norm());
      most_of_own = std::max(most_of_own, std::fabs(by_elastic[1] - expected[1]) / external.norm());
    }
    arm.write({.position = start,
               .velocity = JointVector::Zero(7),
               .stiffness = stiffness,
               .damping = damping,
               .torque = chain.gravity_torque(start)});
    for (int i = 0; i < 10; ++i) arm.step(k < 0 ? arm_plants::ToolForce{} : force);
  }
  EXPECT_LT(off_elastic, 0.05);
  EXPECT_LT(most_of_own, 0.03);
  EXPECT_GT(off_rigid, 0.2);
}

TEST(ElasticTorqueObserver, NeedsTheStiffnessOfEachJointAndACutoffThatTheTickCanHave) {
  const arm::Chain::Params params = arm_plants::openarm_class().chain;
  EXPECT_EQ(ElasticTorqueObserver::make({}, params, JointVector::Constant(3, 600.0), Seconds{tick_s}).error().parameter,
            "joints");
  EXPECT_EQ(ElasticTorqueObserver::make({.cutoff_Hz = 600.0}, params, JointVector::Constant(7, 600.0), Seconds{tick_s})
                .error()
                .parameter,
            "cutoff_Hz");
}

}  // namespace
}  // namespace tactus::arm_control::elastic_torque_observer_test
