// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/cable_chain.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

namespace tactus::mechanics {

Result<CableChain> CableChain::make(const Params& params, Seconds dt) { return make(params, nobody_holds, dt); }

Result<CableChain> CableChain::make(const Params& params, const LinearSpring::Params& grip, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  if (auto error = validate(grip)) return under("grip", *std::move(error));
  const auto linkage = ElastoSlipSpring::make(params.linkage, dt);
  if (!linkage) return under("linkage", linkage.error());
  if (auto error = check_step(params, grip.stiffness_N_per_m, "grip.stiffness_N_per_m", dt)) return *std::move(error);
  Motion motion{.mass_kg = {params.motor.mass_kg, params.drum.mass_kg, params.tip.mass_kg},
                .friction_N = {params.motor.friction_N, params.drum.friction_N},
                .cable_stiffness_N_per_m = params.cable.stiffness_N_per_m,
                .cable_damping_N_s_per_m = params.cable.damping_N_s_per_m,
                .linkage_sustained_N_per_m = linkage->sustained_stiffness_N_per_m(),
                .linkage_damping_N_s_per_m = params.linkage.damping_N_s_per_m,
                .grip_stiffness_N_per_m = grip.stiffness_N_per_m,
                .grip_damping_N_s_per_m = grip.damping_N_s_per_m,
                .step = {},
                .state = {.linkage = linkage->elements()}};
  motion.step = motion.step_of(dt.value);
  return CableChain(motion);
}

Check CableChain::check_step(const Params& params, double tip_stiffness_N_per_m, std::string_view tip_parameter,
                             Seconds dt) {
  const auto spring = ElastoSlipSpring::make(params.linkage, dt);
  if (!spring) return under("linkage", spring.error());
  const double cable = params.cable.stiffness_N_per_m;
  const double linkage = spring->initial_stiffness_N_per_m();
  const double motor_kg = params.motor.mass_kg;
  const double drum_kg = params.drum.mass_kg;
  const double tip_kg = params.tip.mass_kg;

  // The pivots of 4/h² M − K, tridiagonal, are all positive exactly when it is positive definite.
  const double inertia = 4.0 / (dt.value * dt.value);
  const double motor = inertia * motor_kg - cable;
  const double drum = inertia * drum_kg - cable - linkage - cable * cable / motor;
  const double tip = inertia * tip_kg - linkage - tip_stiffness_N_per_m - linkage * linkage / drum;
  if (motor > 0.0 && drum > 0.0 && tip > 0.0) return {};

  struct Connector {
    double stiffness_N_per_m, squared_frequency;
    std::string_view parameter;
  };
  const Connector connectors[] = {
      {cable, cable / motor_kg + cable / drum_kg, "cable.stiffness_N_per_m"},
      {linkage, linkage / drum_kg + linkage / tip_kg, "linkage.stiffness_N_per_m"},
      {tip_stiffness_N_per_m, tip_stiffness_N_per_m / tip_kg, tip_parameter},
  };
  const Connector& stiffest = *std::max_element(
      std::begin(connectors), std::end(connectors),
      [](const Connector& a, const Connector& b) { return a.squared_frequency < b.squared_frequency; });
  return Error{.code = ErrorCode::inconsistent,
               .parameter = std::string(stiffest.parameter),
               .message = "makes the mechanism as stiff as " + rounded_number(std::round(stiffest.stiffness_N_per_m)) +
                          " N/m here, which steps of " + rounded_number(dt.value * 1e6) +
                          " us cannot follow: step finer, or less stiffness or damping, or more mass",
               .place = {}};
}

void CableChain::reset(double position_m) noexcept {
  motion_.state.position_m.fill(position_m);
  motion_.state.velocity_m_per_s.fill(0.0);
  motion_.state.linkage.slider_m = {};
}

}  // namespace tactus::mechanics
