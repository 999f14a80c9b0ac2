// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/vibration_energy.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>

namespace tactus::live {

Result<VibrationEnergy> VibrationEnergy::make(Seconds dt) {
  const auto high_pass = signal::SecondOrderFilter::make(
      {.kind = signal::FilterKind::high_pass, .frequency_Hz = experiments::transient_cutoff_Hz}, dt);
  if (!high_pass) return high_pass.error();
  return VibrationEnergy(*high_pass);
}

void VibrationEnergy::step(double displayed_force_N, double position_m) noexcept {
  const double position_before_m = position_m_;
  position_m_ = position_.step(position_m);
  energy_J_ -= force_N_ * (position_m_ - position_before_m);
  force_N_ = force_.step(displayed_force_N);
}

void VibrationEnergy::reset(double position_m) noexcept {
  force_.reset();
  position_.settle(position_m);
  force_N_ = 0.0;
  position_m_ = 0.0;
  energy_J_ = 0.0;
}

}  // namespace tactus::live
