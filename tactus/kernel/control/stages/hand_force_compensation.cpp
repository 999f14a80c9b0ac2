// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/stages/hand_force_compensation.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/matrix_functions.hpp>

#include <array>
#include <cmath>
#include <numbers>

namespace tactus::control {

std::complex<double> linkage_mode(const MasterModel& master) {
  const double inner_kg = master.motor.mass_kg + master.drum.mass_kg;
  const double outer_kg = master.handle.mass_kg;
  const double linkage_stiffness = master.linkage.stiffness_N_per_m;
  const double linkage_damping = master.linkage.damping_N_s_per_m;
  const double outer_stiffness = linkage_stiffness + master.hand.stiffness_N_per_m;
  const double outer_damping = linkage_damping + master.hand.damping_N_s_per_m;
  // Of positions of inner and outer mass, then velocities.
  const std::array<double, 16> a{0.0,
                                 0.0,
                                 1.0,
                                 0.0,  //
                                 0.0,
                                 0.0,
                                 0.0,
                                 1.0,  //
                                 -linkage_stiffness / inner_kg,
                                 linkage_stiffness / inner_kg,
                                 -linkage_damping / inner_kg,
                                 linkage_damping / inner_kg,  //
                                 linkage_stiffness / outer_kg,
                                 -outer_stiffness / outer_kg,
                                 linkage_damping / outer_kg,
                                 -outer_damping / outer_kg};
  std::complex<double> lightest = 0.0;
  double least_damping = 1.0;
  for (const std::complex<double>& pole : signal::eigenvalues(a, 4)) {
    const double damping = pole.imag() > 0.0 ? -pole.real() / std::abs(pole) : 1.0;
    if (damping < least_damping) {
      least_damping = damping;
      lightest = pole;
    }
  }
  return lightest;
}

Result<HandForceCompensation> HandForceCompensation::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  HandForceCompensation compensation;
  if (params.band_Hz == 0.0) return compensation;
  if (auto error = signal::check_below_nyquist("band_Hz", params.band_Hz, dt)) return *std::move(error);
  const std::complex<double> mode = linkage_mode(params.master);
  if (mode == 0.0) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "band_Hz",
                 .message =
                     "the model of master and hand has no mode between motor and hand that could be undone: "
                     "set it to 0",
                 .place = {}};
  }
  const std::complex<double> zero = std::exp(mode * dt.value);
  const std::complex<double> edge(-std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0);
  const std::complex<double> pole = std::exp(2.0 * std::numbers::pi * params.band_Hz * dt.value * edge);
  const auto at_rest = [](std::complex<double> root) { return std::norm(1.0 - root); };
  const double gain = at_rest(pole) / at_rest(zero);
  compensation.section_ = {.b0 = gain,
                           .b1 = -2.0 * gain * zero.real(),
                           .b2 = gain * std::norm(zero),
                           .a1 = -2.0 * pole.real(),
                           .a2 = std::norm(pole)};
  compensation.on_ = true;
  return compensation;
}

}  // namespace tactus::control
