// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/bonded_run.hpp>
#include <tactus/simulation/experiments/model_mismatch.hpp>

/// The rig of the experiment file without anything that is not linear.
inline tactus::simulation::Teleoperator::Params linear_rig() {
  tactus::simulation::Teleoperator::Params params;
  params.slave.force_sensor.bandwidth_Hz = 1000.0;
  params.control.slave.derivative_N_s_per_m = 0.65;
  params.environment = {.stiffness_N_per_m = 40000.0, .damping_N_s_per_m = 3.0};
  return tactus::stability::linear_version(params);
}

/// Another mass of master and hand in the controller's model.
inline void misjudge_mass(tactus::simulation::Teleoperator::Params& params, double factor) {
  params.control.model = tactus::experiments::mismatched(params.control.model, {.mass = factor});
}
