// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/arm_plants/polled_arm.hpp>

#include <cmath>
#include <cstddef>

#include "tests/allocation_counter.hpp"
#include "tests/arm_plants/openarm.hpp"

namespace tactus::arm_plants {
namespace polled_arm_test {

constexpr double tick_s = 1e-3;

/// The arm falls, so that each reading tells when it was read.
PolledArm polled(const PolledArm::Params& params) {
  return *PolledArm::make(params, *ArmPlant::make(openarm_class(), bent()), 0.0);
}

void run(PolledArm& arm, const ArmCommand& command, int tick) {
  arm.tick(command, tick * tick_s);
  for (int i = 0; i < 10; ++i) arm.step({});
}

TEST(PolledArm, AHostWorksOnAnswersOfSoManyTicksBefore) {
  const ArmCommand command = ArmCommand::of_torque(JointVector::Zero(7));
  for (const int ticks : {1, 2, 9}) {
    PolledArm arm = polled({.answer_ticks = ticks});
    for (int k = 0; k < 30; ++k) {
      EXPECT_NEAR(arm.known().at_s[3], std::max(0, k - ticks) * tick_s, 1e-12) << ticks << " at tick " << k;
      run(arm, command, k);
    }
  }
}

TEST(PolledArm, AJointThatIsNotHeardKeepsItsLawAndTheHostItsReading) {
  Joints<double> lost(7, 0.0);
  lost[1] = 0.6;
  PolledArm arm = polled({.lost_share = lost, .outage_ticks = 8.0, .seed = 3});
  int silent = 0, outages = 0;
  bool before = true;
  double last_at_s = 0.0;
  constexpr int ticks = 20000;
  for (int k = 0; k < ticks; ++k) {
    arm.tick(ArmCommand::of_torque(JointVector::Constant(7, 1e-3 * k)), k * tick_s);
    const bool heard = arm.heard(1);
    EXPECT_TRUE(arm.heard(0));
    EXPECT_EQ(arm.known().at_s[1], heard ? k * tick_s : last_at_s);
    EXPECT_EQ(arm.known().at_s[0], k * tick_s);
    last_at_s = arm.known().at_s[1];
    silent += heard ? 0 : 1;
    outages += before && !heard ? 1 : 0;
    before = heard;
  }
  EXPECT_NEAR(static_cast<double>(silent) / ticks, 0.6, 0.03);
  EXPECT_NEAR(static_cast<double>(silent) / outages, 8.0, 0.6);
}

TEST(PolledArm, ADriveThatIsNotHeardGoesOnByTheCommandBefore) {
  Joints<double> lost(7, 0.0);
  lost[1] = 0.5;
  PolledArm arm = polled({.lost_share = lost, .outage_ticks = 5.0});
  double acts = 0.0;
  for (int k = 1; k < 200; ++k) {
    run(arm, ArmCommand::of_torque(JointVector::Constant(7, 1e-3 * k)), k);
    if (arm.heard(1)) acts = 1e-3 * k;
    EXPECT_NEAR(arm.plant().read().torque[1], acts, 1e-12);
    EXPECT_NEAR(arm.plant().read().torque[0], 1e-3 * k, 1e-12);
  }
}

TEST(PolledArm, RefusesWhatCannotBe) {
  const auto parameter = [](const PolledArm::Params& params) {
    return PolledArm::make(params, *ArmPlant::make(openarm_class(), bent()), 0.0).error().parameter;
  };
  EXPECT_EQ(parameter({.answer_ticks = 0}), "answer_ticks");
  EXPECT_EQ(parameter({.outage_ticks = 0.5}), "outage_ticks");
  EXPECT_EQ(parameter({.lost_share = Joints<double>(3, 0.0)}), "lost_share");
  EXPECT_EQ(parameter({.lost_share = Joints<double>(7, 1.0)}), "lost_share");
  EXPECT_EQ(parameter({.lost_share = Joints<double>(7, 0.9), .outage_ticks = 2.0}), "outage_ticks");
}

TEST(PolledArm, ACopyGoesOnByItselfAndATickDoesNotAllocate) {
  PolledArm arm = polled({.answer_ticks = 4, .lost_share = Joints<double>(7, 0.3), .outage_ticks = 3.0});
  const ArmCommand command = ArmCommand::of_torque(JointVector::Zero(7));
  for (int k = 0; k < 20; ++k) run(arm, command, k);
  PolledArm copy = arm;
  const std::size_t before = laws::allocation_count();
  for (int k = 20; k < 40; ++k) run(arm, command, k);
  EXPECT_EQ(laws::allocation_count(), before);
  for (int k = 20; k < 40; ++k) run(copy, command, k);
  EXPECT_EQ(copy.known().reading.position, arm.known().reading.position);
}

}  // namespace polled_arm_test
}  // namespace tactus::arm_plants
