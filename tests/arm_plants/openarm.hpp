// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/urdf/urdf.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace tactus::arm_plants {

/// The arm of experiments/arms, without friction.
inline ArmPlant::Params openarm_class() {
  const auto read = urdf::read(std::string(TACTUS_EXPERIMENT_FOLDER) + "/arms/openarm-class.urdf");
  if (!read) throw std::runtime_error(describe(read.error()));
  constexpr double armature_kg_m2[] = {0.0167, 0.0167, 0.029, 0.029, 0.0018, 0.0018, 0.0018};
  ArmPlant::Params params{.chain = read->params, .motors = Joints<MotorParams>(7), .tool_m = Vector3(0.0, 0.0, 0.15)};
  for (std::size_t i = 0; i < 7; ++i) {
    params.chain.joints[i].drive.armature_kg_m2 = armature_kg_m2[i];
    params.chain.joints[i].friction = {};
  }
  return params;
}

inline JointVector bent() {
  JointVector q(7);
  q << 0.2, -std::numbers::pi / 2 - 0.2, 0.15, 1.4, 0.2, 0.1, 0.2;
  return q;
}

}  // namespace tactus::arm_plants
