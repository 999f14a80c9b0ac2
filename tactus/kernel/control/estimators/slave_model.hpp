// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/core/parameters.hpp>

namespace tactus::control {

/// What an observer assumes of the slave, M ẍ = K_a u − h ẋ − friction(ẋ) + F_e: one rigid body without delay.
struct SlaveModel {
  double mass_kg = 0.032;
  double viscous_damping_N_s_per_m = 0.0;
  FrictionFunction friction{};
  double actuator_gain = 1.0;
  static constexpr auto fields() {
    return List{field("mass_kg", &SlaveModel::mass_kg, units::kilogram, positive, "Moving mass M."),
                field("viscous_damping_N_s_per_m", &SlaveModel::viscous_damping_N_s_per_m,
                      units::newton_second_per_metre, non_negative, "Viscous damping h."),
                field("friction", &SlaveModel::friction, "Friction in addition to the viscous part."),
                field("actuator_gain", &SlaveModel::actuator_gain, units::none, any_finite,
                      "K_a: force in N per unit of the command.")};
  }
};

}  // namespace tactus::control
