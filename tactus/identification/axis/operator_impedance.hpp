// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/axis_signals.hpp>
#include <tactus/kernel/core/result.hpp>

#include <optional>
#include <vector>

namespace tactus::identification {

/// What the data show of the hand in a stretch of time.
enum class ImpedanceVerdict {
  determined,    ///< motion explains the hand's force; each parameter as far as its interval states
  still,         ///< the device hardly moves in the band: less than a step of its encoder
  hand_drives,   ///< the hand gives energy in the band: what answers is the device, not the hand
  unexplained,   ///< the motion explains less than half of the hand's force in the band
  contradicted,  ///< a parameter is below zero with its whole interval, which no passive hand shows
};

/// The operator's impedance in a stretch of time: force of the hand on the device = −(mass·a + damping·v +
/// stiffness·x) + what the operator intends. Units: kg, N s/m, N/m; of a rotary axis kg m², N m s/rad, N m/rad.
struct OperatorImpedance {
  double from_s = 0;  ///< since the first sample
  double to_s = 0;
  Estimate stiffness, damping, mass;
  double explained = 0;  ///< share of the force's variance in the band, 1 at best
  ImpedanceVerdict verdict = ImpedanceVerdict::still;

  /// Do the data determine this parameter? The verdict is `determined` and its interval is above zero.
  [[nodiscard]] bool determined(const Estimate& parameter) const;
};

struct OperatorImpedanceOptions {
  /// The band in which the hand is judged. A zero-phase filter lets 1/4 through at the lower edge, 1/2 at the upper and
  /// falls with the eighth power below and the fourth above. With 8 Hz a sixtieth passes at 5 Hz.
  double lower_Hz = 8.0;
  std::optional<double> upper_Hz = {};  ///< none: 80 Hz or a tenth of the sample rate, whichever is lower
  double window_s = 2.0;                ///< at least ten periods of the lower edge
  /// Refuse a recording in which the hand takes energy below the band too, as it does when the force has the wrong
  /// sign. False where the sign is known: a device that shakes a resting hand does that as well.
  bool doubt_sign = true;
};

struct OperatorImpedances {
  OperatorImpedance whole;                 ///< of all windows together: an average where the grip changes
  std::vector<OperatorImpedance> windows;  ///< each a quarter of a window later than the one before
  double lower_Hz = 0;
  double upper_Hz = 0;
  double window_s = 0;  ///< rounded to eight blocks of whole samples
};

/// The operator's impedance over time, from the motion of a master and the force of the hand on it.
///
/// The operator also intends motion, and a recording cannot determine that from stiffness and damping at the
/// frequencies at which people move. So the hand is judged above them, where it is passive and answers what the device
/// does. Intention that reaches into the band (tremor, a jerk) biases the result, and where the hand drives the device
/// the ratio of force and motion is the device's: the verdict states where the data show that.
///
/// Each window is a least-squares fit of the band-passed force on acceleration, velocity and position, by instrumental
/// variables: regressors from even samples, instruments from odd ones, so an encoder's steps do not pull the mass down.
/// Intervals of 95 % come from a jackknife over eight blocks (of the whole: over all blocks), so they hold for a
/// residual that is correlated within a block, and a window that owes its result to one jolt gets a wide one.
///
/// A force that is measured later than the position by t_s lowers the mass by damping·t_s.
///
/// Errors: those of `check_axis`; `out_of_bounds` for a band or a window that the recording does not have;
/// `inconsistent` for a recording shorter than a window, for position and force that look swapped and for a force that
/// looks as if its sign were wrong. Not real-time safe.
///
/// Sources: Dolan, Friedman and Nagurka, Dynamic and loaded impedance components in the maintenance of human arm
/// posture, IEEE Trans. SMC 23(3), 1993 (the second-order model in short windows); Söderström and Stoica, Instrumental
/// variable methods for system identification, 1983; Efron, The jackknife, the bootstrap and other resampling plans,
/// 1982.
Result<OperatorImpedances> estimate_operator_impedance(const AxisSignals& signals,
                                                       const OperatorImpedanceOptions& options = {});

}  // namespace tactus::identification
