// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/loop.hpp>

#include <complex>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

/// How far a loop is from instability. Not real-time safe.
namespace tactus::stability {

/// The loop gain at the ticks over frequency, on a grid that follows it: no two neighbours turn by more than 0.1 rad
/// against each other, seen from 0 or from −1, whichever turns more, so that no crossing is missed and turns around −1
/// are counted.
struct LoopCurve {
  std::function<std::complex<double>(double)> at;  ///< L at an angular frequency in rad/s
  std::vector<double> frequency_rad_per_s;         ///< from next to 0 to half the sample rate, rising
  std::vector<std::complex<double>> gain;
};

/// Traces a loop from `lowest_Hz` to half the sample rate.
LoopCurve trace(std::function<std::complex<double>(double)> at, double tick_s, double lowest_Hz = 0.01);
LoopCurve trace(const Loop& loop);

/// The smallest gain, times the loop's own, that puts a closed-loop pole on the unit circle: there L is real and
/// negative. No margin is infinite: no gain does.
struct GainMargin {
  double factor = std::numeric_limits<double>::infinity();
  double frequency_rad_per_s = 0.0;  ///< of that pole; 0 without one
};
GainMargin gain_margin(const LoopCurve& curve);

/// Smallest rotation, at a gain of one, that puts a pole on the unit circle, and the shortest delay that does.
struct PhaseMargin {
  double phase_rad = std::numeric_limits<double>::infinity();
  double phase_frequency_rad_per_s = 0.0;
  double delay_s = std::numeric_limits<double>::infinity();
  double delay_frequency_rad_per_s = 0.0;
};
PhaseMargin phase_margin(const LoopCurve& curve);

/// Smallest distance of L from −1: one over the largest sensitivity.
struct ModulusMargin {
  double distance = 1.0;
  double frequency_rad_per_s = 0.0;
};
ModulusMargin modulus_margin(const LoopCurve& curve);

/// The balanced disk margin α = 2 min |(1 + L) / (1 − L)|: gain and phase may both change at once, by a factor between
/// (2 − α) / (2 + α) and its inverse and by 2 atan(α / 2).
/// Source: Seiler, Packard, Gahinet, An introduction to disk margins, IEEE Control Systems 40(5), 2020.
struct DiskMargin {
  double alpha = 2.0;
  double frequency_rad_per_s = 0.0;
  [[nodiscard]] double gain_factor() const;  ///< infinite from α = 2 on
  [[nodiscard]] double phase_rad() const;
};
DiskMargin disk_margin(const LoopCurve& curve);

/// Poles of the closed loop outside the unit circle, for an open loop without any: how often L turns around −1, by
/// the argument principle. Exact for any delay.
int unstable_poles(const LoopCurve& curve);

/// The largest force gain up to which the loop is stable, and what happens there.
struct GainLimit {
  double force_gain = 0.0;           ///< infinite where no gain makes it unstable; 0 where without force it is already
  double frequency_rad_per_s = 0.0;  ///< at which it then oscillates
};
GainLimit gain_limit(const Loop& loop);

/// Whether both devices are stable without the force between them: local damping and servo may be too strong alone.
bool stable_without_force(const Loop& loop);

}  // namespace tactus::stability
