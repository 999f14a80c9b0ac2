// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <string>

namespace tactus::arm_plants {

/// An arm in MuJoCo's own format. Body and motor of joint i are the i-th; an elastic joint is a motor's hinge and a
/// spring's, one after the other, on the same axis of the same body.
std::string mujoco_text(const ArmPlant::Params& params);

}  // namespace tactus::arm_plants
