// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/bench_model.hpp>
#include <tactus/kernel/control/model/induced_motion_model.hpp>

#include <vector>

/// From what was found on the bench to the model that the controller cancels with.
namespace tactus::identification {

/// The model made fit for cancellation (paper A, Sec. VI and VIII-A): a quintic spring k₅ = F/δ⁵ holds its slow
/// deflection to `full_deflection_m` at `full_force_N`, about a tenth of the hand's own, because the operator takes
/// slow deflections out and an overestimate would be positive feedback.
///
/// The controller knows the force that it commands, not the one that the amplifier applies: masses, stiffnesses,
/// damping and friction are divided by the amplifier's gain, so that the model moves under a commanded newton as the
/// device does. Viscous damping of the linkage that came out below zero counts as none.
control::MasterModel model_for_cancellation(const BenchParams& found, double full_force_N, double full_deflection_m);

/// Impacts that no fit has seen, displayed to the held master: what the model leaves of the motion that they induce.
struct ImpactCheck {
  double tick_s = 0.0;
  std::vector<double> force_N;     ///< as commanded
  std::vector<double> measured_m;  ///< above 20 Hz
  std::vector<double> modelled_m;  ///< above 20 Hz
  double residual = 0.0;  ///< rms of measured less modelled over rms of measured, above 20 Hz, in the 60 ms from
                          ///< the start of each impact
};

/// Six impacts, rings of 60, 90 and 140 Hz that die away over 25 ms about a push of 0.25 to 1 times `full_force_N`.
/// The model runs as in a controller, open loop, friction at rest. Errors: those of the rig.
Result<ImpactCheck> check_on_impacts(Rig& rig, const control::MasterModel& model, double full_force_N);

}  // namespace tactus::identification
