// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/estimators/disturbance_observer.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cmath>
#include <numbers>

namespace tactus::control {

Result<DisturbanceObserver> DisturbanceObserver::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto velocity = signal::FilteredDerivative::make({.cutoff_Hz = params.cutoff_Hz}, dt);
  if (!velocity) return velocity.error();
  const auto low_pass =
      signal::SecondOrderFilter::make({.kind = signal::FilterKind::low_pass, .frequency_Hz = params.cutoff_Hz}, dt);
  if (!low_pass) return under("cutoff_Hz", low_pass.error());
  // The continuous frequency that the bilinear transform takes to the cutoff.
  const double omega = 2.0 / dt.value * std::tan(std::numbers::pi * params.cutoff_Hz * dt.value);
  const auto inertia = signal::RationalFilter::make({.numerator_0 = 0.0,
                                                     .numerator_1 = params.model.viscous_damping_N_s_per_m,
                                                     .numerator_2 = params.model.mass_kg,
                                                     .denominator_0 = 1.0,
                                                     .denominator_1 = std::numbers::sqrt2 / omega,
                                                     .denominator_2 = 1.0 / (omega * omega)},
                                                    dt);
  if (!inertia) return under("cutoff_Hz", inertia.error());
  return DisturbanceObserver(params.model, *velocity, *inertia, *low_pass);
}

}  // namespace tactus::control
