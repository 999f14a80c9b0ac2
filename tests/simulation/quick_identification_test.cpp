// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/cancellation_model.hpp>
#include <tactus/identification/axis/quick.hpp>
#include <tactus/simulation/teleoperator/simulated_rig.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>

#include <gtest/gtest.h>

namespace tactus::simulation {
namespace quick_identification_test {

using identification::FoundParameter;
using identification::Isolation;

const FoundParameter& named(const Isolation& found, std::string_view name) {
  return *std::find_if(found.parameters.begin(), found.parameters.end(),
                       [&](const FoundParameter& parameter) { return parameter.name == name; });
}

TEST(QuickIdentification, AHeldMasterTellsItsStiffnessAndDampingButNotTheFrictionOfEachPart) {
  SimulatedRig rig = SimulatedRig::make(draw_rig(1004)).value();
  // Shorter than a minute, so that the test is.
  const Isolation found =
      identification::identify_quickly(rig, {.data_sheet = {}, .slow_sweep_s = 6.0, .sweep_s = 1.0}, {}).value();
  for (const char* name : {"linkage.stiffness_N_per_m", "cable.stiffness_N_per_m", "operator.damping_N_s_per_m"}) {
    const double truth = rig.truth(name).value();
    EXPECT_NEAR(named(found, name).value, truth, 0.1 * truth) << name;
    EXPECT_TRUE(named(found, name).determined) << name;
  }
  EXPECT_FALSE(named(found, "motor.friction_N").determined);
  EXPECT_FALSE(named(found, "linkage.damping_N_s_per_m").determined);

  const auto model = identification::model_for_cancellation(found.found, 1.0, 2e-3);
  EXPECT_LT(identification::check_on_impacts(rig, model, 1.0).value().residual, 0.35);
}

}  // namespace quick_identification_test
}  // namespace tactus::simulation
