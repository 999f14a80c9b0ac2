// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/axis_signals.hpp>
#include <tactus/identification/diagnosis/signals.hpp>

#include <optional>
#include <string>

namespace tactus::diagnosis {

/// How the follower comes after the leader, at the frequencies at which the leader moves.
struct Following {
  /// Time by which the follower is behind the leader; negative if it is before it. [s]
  identification::Estimate lag_s = {};
  double moves_to_Hz = 0.0;  ///< up to this frequency the leader moves and the follower follows coherently
  /// The part of the lag that is the same at all frequencies, apart from a servo. None if the leader moves too slowly
  /// to separate the two. [s]
  std::optional<identification::Estimate> constant_s = {};
  /// Where the follower, after the constant delay, moves 3 dB less far than at low frequencies. None if not separated,
  /// or beyond `moves_to_Hz`.
  std::optional<double> bandwidth_Hz = {};
};

/// Compares both positions. The lag is where the correlation of their motion over 50 ms has its maximum, -0.1 s to
/// 0.5 s, with the interval of a jackknife over eight blocks. The parts are those of the model
/// H(s) = g·exp(−s·T) / (1 + a·s + b·s²), fitted to the frequency response (`response_h1`) where its coherence is at
/// least 0.8, for each T; T is separated if the fits that are nearly as good have a T within a fifth of the lag, or
/// within a quarter of a sample.
///
/// None if a position is missing or does not move, or if the two do not move together (correlation below 0.9). Not
/// real-time safe.
std::optional<Following> find_following(const Signals& signals);

/// In sentences: the lag, its parts as far as they are determined, what the sample rate adds, and what a recording at
/// this rate cannot show.
std::string text_of(const Following& following, const Signals& signals);

}  // namespace tactus::diagnosis
