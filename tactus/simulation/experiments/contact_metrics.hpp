// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace tactus::experiments {

/// How a contact went, judged from the force on the slave's tip over an observation window that starts at the first
/// touch. "Force above 15 Hz" is the contact force behind a second-order Butterworth high-pass at 15 Hz: what is left
/// is the transient, without the slow push of the hand.
struct ContactMetrics {
  int contacts = 0;            ///< times that the tip met the wall
  bool settled = false;        ///< the force above 15 Hz fell below a tenth of its peak and stayed there
  double settling_time_s = 0;  ///< from first touch until it did; the whole window for a contact that did not settle
  double peak_force_N = 0;     ///< largest contact force
  double residual_rms_N = 0;   ///< RMS of the force above 15 Hz over the last 100 ms of the window
};

/// How many ticks come nearest to a duration.
inline std::size_t ticks_in(double duration_s, double tick_s) {
  return static_cast<std::size_t>(std::lround(duration_s / tick_s));
}

/// Corner of the high-pass before "force above 15 Hz".
inline constexpr double transient_cutoff_Hz = 15.0;
/// What is left of the peak in a contact that has settled.
inline constexpr double settled_share = 0.1;
/// The transient must stay small for at least this long at the end of the window to count as settled.
inline constexpr double quiet_time_s = 0.05;

/// A force in N, sampled every `tick_s`, behind that high-pass. Not real-time safe.
std::vector<double> force_transient(std::span<const double> force_N, double tick_s);

/// Judges one contact from the mean contact force of each tick, in N, sampled every `tick_s`. `first_touch` is the tick
/// of the first touch; everything from there to the end is the observation window. `contacts` and `peak_force_N` are
/// for the caller to fill in. Not real-time safe.
ContactMetrics judge_contact(std::span<const double> contact_force_N, std::size_t first_touch, double tick_s);

}  // namespace tactus::experiments
