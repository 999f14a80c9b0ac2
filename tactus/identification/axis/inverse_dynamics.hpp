// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/axis_signals.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <optional>
#include <vector>

namespace tactus::identification {

/// An inverse dynamic model, force = inertia·a + viscous·v + coulomb·tanh(v/friction_speed) + offset. Units: kg, N s/m,
/// N, m/s; of a rotary axis kg m², N m s/rad, N m, rad/s.
struct InverseDynamics {
  Estimate inertia, viscous, coulomb, offset;
  /// The same four by least squares alone, without instruments.
  std::array<double, 4> least_squares = {};
  double friction_speed = 0;  ///< chosen, not fitted
  double cutoff_Hz = 0;       ///< of the zero-phase filter
  double explained = 0;       ///< share of the force's variance, 1 at best
  double residual_rms = 0;    ///< in the filter's band [N or N m]
  /// In the filter's band, for a plot; the ends, where the filter has to guess, are cut off.
  std::vector<double> time_s, velocity, measured, modelled;
};

/// Fits the model to a recording of free motion. The force is all that drives the axis, friction and inertia excepted.
///
/// Position and force pass the same zero-phase low-pass, then the position is differentiated, so the filter biases
/// nothing linear. Parameters come from instrumental variables: the regressors from the even samples of the position,
/// the instruments from the odd ones, whose quantisation and noise are others, so noise in the regressors does not pull
/// the inertia toward zero as it does in least squares.
///
/// The residual is coloured (friction that the model does not have, the filter), so intervals come from the scatter of
/// the score over twelve blocks of the recording (Student's t, 11 degrees of freedom): they hold for any correlation
/// shorter than a block.
///
/// `cutoff_Hz`: of the filter; none: 30 Hz or a tenth of the sample rate, whichever is lower.
///
/// Errors, in place of a model that nobody should trust: those of `check_axis`; `inconsistent` for motion in one
/// direction only, position and force swapped, force of the wrong sign, friction that gives energy, a residual that
/// follows the position (a contact or a spring), a model that explains less than half of the force, or an inertia whose
/// interval includes zero. Not real-time safe. Sources: Gautier, Janot and Vandanjon, A new closed-loop output error
/// method for parameter identification of robot dynamics, IEEE Trans. Control Systems Technology 21(2), 2013 (the
/// inverse dynamic model and its filters); Söderström and Stoica, Instrumental variable methods for system
/// identification, 1983.
Result<InverseDynamics> fit_inverse_dynamics(const AxisSignals& signals, std::optional<double> cutoff_Hz = {});

}  // namespace tactus::identification
