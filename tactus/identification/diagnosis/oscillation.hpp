// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/diagnosis/signals.hpp>

#include <string>
#include <vector>

namespace tactus::diagnosis {

/// A line that stays: what shakes, when and where it shows best.
struct Oscillation {
  double frequency_Hz = 0;
  double from_s = 0;  ///< since the first sample
  double to_s = 0;
  double share =
      0;  ///< 0 to 1: of the power above half of the frequency, in the signal and time in which it shows best
  std::string signal;  ///< which that is
  [[nodiscard]] double cycles() const { return frequency_Hz * (to_s - from_s); }
};

/// How the slave's position scales with the master's: the slope of one over the other; 1 where either is missing or
/// does not move.
double position_scale(const Signals& signals);

/// The slave's position less the scaled master's; empty where either is missing.
std::vector<double> following_error(const Signals& signals);

/// Finds oscillations from 1.25 Hz (or five periods in half of the recording, where that is more) to 0.45 of the sample
/// rate, the strongest first.
///
/// Frames of four, two and a half seconds are looked through, each for frequencies of which it holds five to twenty
/// periods and more. A line counts where it and its harmonics hold more than two fifths of the power between 0.6 and
/// eight times its frequency, and it is an oscillation where its envelope stays above two fifths of its usual size for
/// twenty periods (twelve below 10 Hz, four below 2.5 Hz) and for a second without fading: a ringing that fades is
/// none. What has the same frequency or a multiple of it at the same time is one oscillation. Not real-time safe.
std::vector<Oscillation> find_oscillations(const Signals& signals);

}  // namespace tactus::diagnosis
