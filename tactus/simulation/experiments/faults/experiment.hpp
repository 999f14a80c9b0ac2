// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/table.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/experiments/faults/table.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::experiments {

/// The table of faults as an experiment.
std::unique_ptr<const Experiment> faults_experiment();

/// The error for a request that varies keys.
Check refuse_variations(const Request& request);

/// A run that did not survive at the real clock. With no tick missed it is the run of virtual time, bit for bit: where
/// that survives, nothing but the missed ticks can have lost this one.
struct LostInRealTime {
  FaultRow row;
  FaultFailure failure;
  std::int64_t missed_ticks = 0;       ///< while it ran, and those alongside it
  std::int64_t longest_gap_ticks = 0;  ///< most of them in a row
  std::int64_t late_ours = 0;          ///< late ticks that our own step made so, not the machine
  bool survives_on_time = false;
};

/// The same faults at the real clock, and how that was kept.
struct FaultsInRealTime {
  FaultsParams params;               ///< of these runs
  std::vector<FaultTally> tallies;   ///< of the rows; controls are for virtual time
  std::vector<LostInRealTime> lost;  ///< of the rows that must survive
  std::vector<report::Table> timing;
  std::string timing_json;  ///< one document
};

/// What came of the faults, for every reader.
Outcome present_faults(const Request& request, const FaultsParams& params, const FaultTable& table,
                       const std::optional<FaultsInRealTime>& real_time);

}  // namespace tactus::experiments
