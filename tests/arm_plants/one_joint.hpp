// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/arm_plants/openarm.hpp"

/// What tests of one joint and of a whole arm have in common.
namespace tactus::arm_plants {

inline const ToolForce nothing{};

inline void set_elastic(ArmPlant::Params& params, double stiffness_N_m_per_rad, double damping_N_m_s_per_rad = 0.0) {
  for (MotorParams& motor : params.motors) {
    motor.joint_stiffness_N_m_per_rad = stiffness_N_m_per_rad;
    motor.joint_damping_N_m_s_per_rad = damping_N_m_s_per_rad;
  }
}

/// One joint about the upright, which no weight loads.
inline ArmPlant::Params turntable(double armature_kg_m2, const arm::JointFriction& friction) {
  ArmPlant::Params params{.chain = {.joints = Joints<arm::JointParams>(1), .gravity = {}},
                          .motors = Joints<MotorParams>(1)};
  params.chain.joints[0].body = {.mass_kg = 1.0, .xx_kg_m2 = 0.01, .yy_kg_m2 = 0.01, .zz_kg_m2 = 0.01};
  params.chain.joints[0].drive.armature_kg_m2 = armature_kg_m2;
  params.chain.joints[0].friction = friction;
  return params;
}
inline JointVector one(double value) { return JointVector::Constant(1, value); }

}  // namespace tactus::arm_plants
