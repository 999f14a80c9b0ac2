#pragma once

#include <tactus/experiments/experiment.hpp>
#include <tactus/experiments/faults/table.hpp>
#include <tactus/report/table.hpp>

#include <optional>
#include <string>
#include <vector>

namespace tactus::experiments {

/// The table of faults as an experiment: `task.kind = "faults"`.
class FaultExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "faults"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  /// Errors besides those of every experiment: `inconsistent` for a varied key.
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

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
