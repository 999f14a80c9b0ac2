// SPDX-License-Identifier: Apache-2.0
#include "tests/laws.hpp"

#include <tactus/kernel/mechanics/amplifier.hpp>
#include <tactus/kernel/mechanics/bouc_wen.hpp>
#include <tactus/kernel/mechanics/contact.hpp>
#include <tactus/kernel/mechanics/elasto_slip.hpp>
#include <tactus/kernel/mechanics/encoder.hpp>
#include <tactus/kernel/mechanics/force_sensor.hpp>
#include <tactus/kernel/mechanics/friction.hpp>
#include <tactus/kernel/mechanics/springs.hpp>

namespace tactus::laws {

/// Friction acts on a mass that is there.
template <>
struct Subject<mechanics::CoulombFriction> {
  static constexpr double dt_s = 200e-6;
  static std::vector<mechanics::CoulombFriction::Params> parameters() { return {{}, {.force_N = 0.0}}; }
  static void admit(mechanics::CoulombFriction::Input& input) {
    input.mass_kg = std::max(std::fabs(input.mass_kg), std::numeric_limits<double>::denorm_min());
  }
};

template <>
struct Subject<mechanics::Encoder> {
  static constexpr double dt_s = 200e-6;
  static std::vector<mechanics::Encoder::Params> parameters() {
    return {{.resolution_m = 1e-6}, {.resolution_m = 0.0}};
  }
  static void admit(double&) {}
};

using MechanicsElements =
    ::testing::Types<mechanics::LinearSpring, mechanics::QuinticSpring, mechanics::ElastoSlipSpring,
                     mechanics::BoucWenSpring, mechanics::CoulombFriction, mechanics::KelvinVoigtContact,
                     mechanics::HuntCrossleyContact, mechanics::Encoder, mechanics::CurrentAmplifier,
                     mechanics::ForceSensor>;
INSTANTIATE_TYPED_TEST_SUITE_P(Mechanics, ElementLaws, MechanicsElements);

}  // namespace tactus::laws
