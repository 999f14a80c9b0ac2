// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

/// The bodies of lumped devices: what plants, and models of them, are described with.
namespace tactus::mechanics {

/// A body that rubs: its mass, and the Coulomb friction between it and the ground.
struct RubbingMass {
  double mass_kg = 0.01;
  double friction_N = 0.0;
  static constexpr auto fields() {
    return List{field("mass_kg", &RubbingMass::mass_kg, units::kilogram, positive, "Mass, felt at the hand."),
                field("friction_N", &RubbingMass::friction_N, units::newton, non_negative,
                      "Coulomb friction against the ground, felt at the hand.")};
  }
};

/// A body that moves freely.
struct FreeMass {
  double mass_kg = 0.01;
  static constexpr auto fields() {
    return List{field("mass_kg", &FreeMass::mass_kg, units::kilogram, positive, "Mass, felt at the hand.")};
  }
};

}  // namespace tactus::mechanics
