// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/isolation.hpp>

/// The short way: a master that nobody takes apart, identified in the operator's hand within a minute.
namespace tactus::identification {

/// What is known before, and how hard the master is excited.
struct QuickParams {
  BenchParams data_sheet;         ///< nominal values
  double data_sheet_error = 0.3;  ///< their standard deviation in proportion; twice that for the hand
  double slow_sweep_s = 30.0;     ///< 20 to 0.1 Hz
  double sweep_s = 6.0;           ///< each of the three faster sweeps
};

/// Excites the held master with sweeps of several amplitudes and with bursts, and fits the whole chain at once.
///
/// Many values of a chain explain one motion of its end nearly as well: friction of motor and drum act as one, the
/// mass of the handle hides behind the hand. So each value is drawn to its data sheet as much as that is trusted
/// (maximum a posteriori), and one that the minute leaves nearly as unknown as it was states it. The faster runs count
/// above 15 Hz only, where neither tremor nor the operator's corrections are; how much each run counts follows from
/// what the first fit leaves of it and how long that stays correlated. Errors: those of the rig and of the fit. Not
/// real-time safe.
Result<Isolation> identify_quickly(Rig& rig, const QuickParams& params, const IsolationProgress& progress);

}  // namespace tactus::identification
