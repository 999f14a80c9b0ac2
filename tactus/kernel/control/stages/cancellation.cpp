// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/stages/cancellation.hpp>

namespace tactus::control {

Result<Cancellation> Cancellation::make(const Params& params, Seconds dt) {
  const auto model = InducedMotionModel::make(params.model, dt);
  if (!model) {
    // The sample time is a parameter of the whole and not of the model.
    if (model.error().parameter == "dt") return model.error();
    return under("model", model.error());
  }
  const auto intended_velocity = signal::FilteredDerivative::make(params.intended_velocity, dt);
  if (!intended_velocity) return under("intended_velocity", intended_velocity.error());
  return Cancellation(*model, *intended_velocity);
}

}  // namespace tactus::control
