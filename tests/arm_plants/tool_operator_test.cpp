// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/arm_plants/tool_operator.hpp>

#include <cmath>
#include <numbers>

#include "tests/arm_plants/openarm.hpp"

namespace tactus::arm_plants {
namespace {

constexpr double tick_s = 1e-3;

/// A person who wants the tool to stay, and an arm without weight or friction but the motors' torques.
struct Held {
  ArmPlant arm;
  ToolOperator person;
  Vector3 start_m;

  Held(const ToolOperator::Params& params, double viscous_N_m_s_per_rad)
      : Held(arm_of(params, viscous_N_m_s_per_rad), params) {}
  void run(double duration_s, const ToolForce& load) {
    for (int tick = 0; tick < static_cast<int>(duration_s / tick_s); ++tick) {
      person.begin_tick(start_m, start_m, arm.tool());
      for (int i = 0; i < 10; ++i) {
        ToolForce force = person.force(arm.tool(), i * 1e-4);
        force.force_N += load.force_N;
        force.moment_N_m += load.moment_N_m;
        arm.step(force);
      }
    }
  }

 private:
  Held(ArmPlant made, const ToolOperator::Params& params)
      : arm(std::move(made)),
        person(*ToolOperator::make(params, Seconds{tick_s}, arm.tool())),
        start_m(arm.tool().position_m) {}
  static ArmPlant arm_of(const ToolOperator::Params& params, double viscous_N_m_s_per_rad) {
    ArmPlant::Params plant = openarm_class();
    plant.chain.gravity = {0.0, 0.0, 0.0};
    plant.carried_kg = params.hand.mass_kg;
    for (arm::JointParams& joint : plant.chain.joints) joint.friction.viscous_N_m_s_per_rad = viscous_N_m_s_per_rad;
    return *ArmPlant::make(plant, bent());
  }
};

TEST(ToolOperator, YieldsToAForceByWhatTheHandsStiffnessSays) {
  const ToolOperator::Params params{
      .hand = {.mass_kg = 0.4, .stiffness_N_per_m = 400.0, .damping_N_s_per_m = 30.0, .lever_m = 0.1},
      .correction_gain_per_s = 0.0};
  Held held(params, 0.3);
  const Vector3 force_N(2.0, -1.0, 4.0);
  held.run(4.0, {.force_N = force_N});
  EXPECT_LT((held.arm.tool().position_m - held.start_m - force_N / 400.0).norm(), 1e-5);
  Held turned(params, 0.3);
  const arm::Matrix3 before = turned.arm.tool().rotation;
  const Vector3 moment_N_m(0.1, 0.2, -0.1);
  turned.run(4.0, {.moment_N_m = moment_N_m});
  const arm::Matrix3 turn = turned.arm.tool().rotation * before.transpose();
  const Vector3 by(turn(2, 1), turn(0, 2), turn(1, 0));
  EXPECT_LT((by - moment_N_m / (400.0 * 0.01)).norm(), 1e-3);
}

TEST(ToolOperator, TremblesAlongEachAxisAThirdOfACycleApart) {
  const ToolOperator::Params params{
      .hand = {.mass_kg = 0.4, .stiffness_N_per_m = 400.0, .damping_N_s_per_m = 30.0, .lever_m = 0.1},
      .correction_gain_per_s = 0.0,
      .tremor_amplitude_m = 2e-4,
      .tremor_frequency_Hz = 9.0};
  const ToolState still{.position_m = Vector3(0.3, 0.1, 0.2),
                        .rotation = arm::Matrix3::Identity(),
                        .velocity_m_per_s = Vector3::Zero(),
                        .turning_rad_per_s = Vector3::Zero()};
  ToolOperator person = *ToolOperator::make(params, Seconds{tick_s}, still);
  const double rad_per_s = 2.0 * std::numbers::pi * 9.0;
  for (int tick = 0; tick < 500; ++tick) {
    person.begin_tick(still.position_m, still.position_m, still);
    const Vector3 force_N = person.force(still, 0.5 * tick_s).force_N;
    for (int axis = 0; axis < 3; ++axis) {
      // The damper takes the mean speed of a tick, which is that of its middle.
      const double phase = rad_per_s * tick_s * (tick + 0.5) + 2.0 * std::numbers::pi * axis / 3.0;
      EXPECT_NEAR(force_N[axis], 2e-4 * (400.0 * std::sin(phase) + 30.0 * rad_per_s * std::cos(phase)), 3e-4);
    }
  }
}

TEST(ToolOperator, CorrectsSlowlyWhatPushesTheToolAway) {
  const ToolOperator::Params params{
      .hand = {.mass_kg = 0.4, .stiffness_N_per_m = 400.0, .damping_N_s_per_m = 30.0, .lever_m = 0.1}};
  Held held(params, 0.3);
  const ToolForce load{.force_N = Vector3(0.0, 0.0, 4.0)};
  held.run(0.09, load);
  const double at_once_m = held.arm.tool().position_m.z() - held.start_m.z();
  EXPECT_GT(at_once_m, 0.003);
  held.run(4.0, load);
  EXPECT_LT(std::fabs(held.arm.tool().position_m.z() - held.start_m.z()), 1e-4);
}

TEST(ToolOperator, AWallPushesAndNeverPulls) {
  Wall wall{.point_m = Vector3(0.0, 0.0, 1.0),
            .normal = Vector3::UnitZ(),
            .contact = *mechanics::Environment::make({.stiffness_N_per_m = 1000.0, .damping_N_s_per_m = 10.0},
                                                     Seconds{tick_s})};
  ToolState tool{.position_m = Vector3(5.0, 5.0, 1.001),
                 .rotation = arm::Matrix3::Identity(),
                 .velocity_m_per_s = Vector3(0, 0, -1),
                 .turning_rad_per_s = Vector3::Zero()};
  EXPECT_EQ(wall.force_N(tool), Vector3::Zero());
  tool.position_m.z() = 0.99;
  EXPECT_LT((wall.force_N(tool) - Vector3(0.0, 0.0, 20.0)).norm(), 1e-12);
  tool.velocity_m_per_s.z() = 2.0;
  EXPECT_EQ(wall.force_N(tool), Vector3::Zero());
}

constexpr double mass_kg = 0.5;

/// A point of `mass_kg` that slides along z without weight, thrown at a wall of Hunt and Crossley that it meets at 0:
/// speed after over speed before.
double restitution(double dissipation_s_per_m, double exponent, double speed_m_per_s) {
  constexpr double step_s = 1e-6;
  arm::JointParams slide;
  slide.kind = arm::JointKind::prismatic;
  slide.axis = {.x = 0.0, .y = 0.0, .z = 1.0};
  slide.body = {.mass_kg = mass_kg, .xx_kg_m2 = 1e-4, .yy_kg_m2 = 1e-4, .zz_kg_m2 = 1e-4};
  ArmPlant::Params params{.chain = {.joints = Joints<arm::JointParams>(1, slide), .gravity = {0.0, 0.0, 0.0}},
                          .motors = Joints<MotorParams>(1),
                          .step_s = step_s};
  ArmPlant point = *ArmPlant::make(params, arm::JointVector::Constant(1, 1e-4));
  for (int i = 0; i < 1000; ++i) point.step({.force_N = Vector3(0.0, 0.0, -mass_kg * speed_m_per_s / 1e-3)});
  Wall wall{.point_m = Vector3(0.0, 0.0, -1e-4),
            .normal = Vector3::UnitZ(),
            .contact = *mechanics::Environment::make({.law = mechanics::ContactLaw::hunt_crossley,
                                                      .stiffness_N_per_m = 20000.0,
                                                      .exponent = exponent,
                                                      .dissipation_s_per_m = dissipation_s_per_m},
                                                     Seconds{step_s})};
  const double before_m_per_s = point.tool().velocity_m_per_s.z();
  bool touched = false;
  for (int i = 0; i < 1000000; ++i) {
    const Vector3 force_N = wall.force_N(point.tool());
    EXPECT_GE(force_N.z(), 0.0) << "it never pulls";
    if (touched && force_N == Vector3::Zero()) break;
    touched = touched || force_N != Vector3::Zero();
    point.step({.force_N = force_N});
  }
  return -point.tool().velocity_m_per_s.z() / before_m_per_s;
}

TEST(ToolOperator, AWallOfHuntAndCrossleyThrowsAPointBackAsItsClosedFormSays) {
  // m v dv/dδ = −k δⁿ (1 + c v) separates: G(v) = v/c − ln(1 + c v)/c² is the same on the way in and out, whatever k, n
  // and m. For slow impacts that is Hunt and Crossley's e = 1 − 2/3 c v.
  for (const double exponent : {1.0, 1.5, 2.5}) {
    for (const double c : {0.5, 4.0}) {
      constexpr double speed_m_per_s = 0.15;
      const auto g = [c](double v) { return v / c - std::log1p(c * v) / (c * c); };
      double slow = 0.0, fast = 1.0;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (slow + fast);
        (g(-middle * speed_m_per_s) < g(speed_m_per_s) ? slow : fast) = middle;
      }
      EXPECT_NEAR(restitution(c, exponent, speed_m_per_s), slow, 1e-3) << "n " << exponent << ", c " << c;
    }
  }
  for (const double speed_m_per_s : {0.02, 0.04}) {
    const double lost = 1.0 - restitution(0.5, 1.5, speed_m_per_s);
    EXPECT_NEAR(lost, 2.0 / 3.0 * 0.5 * speed_m_per_s, 0.05 * lost) << speed_m_per_s;
  }
}

TEST(ToolOperator, RefusesWhatNoPersonIs) {
  const ArmPlant arm = *ArmPlant::make(openarm_class(), bent());
  EXPECT_EQ(ToolOperator::make({.correction_gain_per_s = 50.0}, Seconds{tick_s}, arm.tool()).error().parameter,
            "correction_gain_per_s");
}

}  // namespace
}  // namespace tactus::arm_plants
