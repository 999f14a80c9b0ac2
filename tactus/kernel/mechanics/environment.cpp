// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/environment.hpp>

namespace tactus::mechanics {

Result<Environment> Environment::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto kelvin_voigt = KelvinVoigtContact::make(
      {.stiffness_N_per_m = params.stiffness_N_per_m, .damping_N_s_per_m = params.damping_N_s_per_m}, dt);
  if (!kelvin_voigt) return kelvin_voigt.error();
  const auto hunt_crossley = HuntCrossleyContact::make({.stiffness_N_per_m = params.stiffness_N_per_m,
                                                        .exponent = params.exponent,
                                                        .dissipation_s_per_m = params.dissipation_s_per_m},
                                                       dt);
  if (!hunt_crossley) return hunt_crossley.error();
  const auto bond = LinearSpring::make(
      {.stiffness_N_per_m = params.stiffness_N_per_m, .damping_N_s_per_m = params.damping_N_s_per_m}, dt);
  if (!bond) return bond.error();
  return Environment(params, *kelvin_voigt, *hunt_crossley, *bond);
}

}  // namespace tactus::mechanics
