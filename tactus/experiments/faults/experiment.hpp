#pragma once

#include <tactus/experiments/experiment.hpp>
#include <tactus/experiments/faults/table.hpp>
#include <tactus/report/table.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::experiments {

/// The table of faults as an experiment.
std::unique_ptr<const Experiment> faults_experiment();

/// The error for a request that varies keys.
Check refuse_variations(const Request& request);

/// The same faults at the real clock, and how that was kept.
struct FaultsInRealTime {
  FaultsParams params;              ///< of these runs
  std::vector<FaultTally> tallies;  ///< of the rows; controls are for virtual time
  std::vector<report::Table> timing;
  std::string timing_json;  ///< one document
};

/// What came of the faults, for every reader.
Outcome present_faults(const Request& request, const FaultsParams& params, const FaultTable& table,
                       const std::optional<FaultsInRealTime>& real_time);

}  // namespace tactus::experiments
