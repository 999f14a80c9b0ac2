// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/model/induced_motion_model.hpp>
#include <tactus/kernel/core/parameters.hpp>

namespace tactus::experiments {

/// How far the controller's model is off: factors on what its parameters would be.
struct ModelMismatch {
  double mass = 1.0;
  double linkage_stiffness = 1.0;
  double operator_damping = 1.0;
  static constexpr auto fields() {
    return List{field("mass", &ModelMismatch::mass, units::none, between(0.2, 5.0),
                      "Factor on the masses of motor, drum and handle."),
                field("linkage_stiffness", &ModelMismatch::linkage_stiffness, units::none, between(0.2, 5.0),
                      "Factor on the stiffness of the linkage."),
                field("operator_damping", &ModelMismatch::operator_damping, units::none, between(0.2, 5.0),
                      "Factor on the damping of the operator's hand.")};
  }
};

/// The model as it would be with these errors in it.
inline control::MasterModel mismatched(control::MasterModel model, const ModelMismatch& mismatch) {
  model.motor.mass_kg *= mismatch.mass;
  model.drum.mass_kg *= mismatch.mass;
  model.handle.mass_kg *= mismatch.mass;
  model.linkage.stiffness_N_per_m *= mismatch.linkage_stiffness;
  model.hand.damping_N_s_per_m *= mismatch.operator_damping;
  return model;
}

}  // namespace tactus::experiments
