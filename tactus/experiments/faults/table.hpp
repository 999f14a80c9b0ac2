#pragma once

#include <tactus/experiments/faults/rows.hpp>
#include <tactus/experiments/faults/run.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// The table of faults: many seeded runs of each, and what came of them.
namespace tactus::experiments {

/// A run that did not survive.
struct FaultFailure {
  std::int64_t number = 0;  ///< of its plan
  std::string_view rule;    ///< that it broke
};

struct FaultTally {
  FaultRow row;
  std::int64_t tried = 0;
  std::int64_t survived = 0;
  std::int64_t diverged = 0;
  std::int64_t stopped = 0;
  std::int64_t detected = 0;
  double simulated_s = 0.0;
  std::vector<FaultFailure> failures;
  FaultOutcome worst{};  ///< sums of the counts, largest of the rest
  double time_to_stop_median_s = 0.0;
  double time_to_stop_most_s = 0.0;
  double detection_ticks_median = 0.0;
  double detection_ticks_most = 0.0;

  /// What shows that the row means something: a control, most of whose runs must not survive.
  [[nodiscard]] bool fails() const { return 2 * survived <= tried; }
};

/// The plans of a row.
std::vector<FaultPlan> draw_plans(const FaultRow& row, const FaultsParams& params);
/// Those of its control: as many, the first that can show what is switched off.
std::vector<FaultPlan> draw_control_plans(const FaultRow& row, const FaultsParams& params);

/// What came of the runs of a row, one outcome for each plan, and the rule that each broke, in words, empty where it
/// survived. A run `diverged` in which the master gave more energy than this.
FaultTally tally(const FaultRow& row, const std::vector<FaultPlan>& plans, const std::vector<FaultOutcome>& outcomes,
                 const std::vector<std::string_view>& broken_rules, double diverged_above_J);
/// The same of the rules of `params`.
FaultTally tally(const FaultRow& row, const FaultsParams& params, const std::vector<FaultPlan>& plans,
                 const std::vector<FaultOutcome>& outcomes);

/// What came of every row, and of the controls of those that have one.
struct FaultTable {
  std::vector<FaultTally> rows;
  std::vector<FaultTally> controls;
};

/// The error for an `id` that none of the `rows` has, naming `key` and their ids.
Error unknown_row(const std::string& key, const std::string& id, const std::vector<FaultRow>& rows);
/// The rows that `params` ask for, or an error that names `task.only`.
Result<std::vector<FaultRow>> chosen_rows(const FaultsParams& params);

/// Runs the rows and their controls in virtual time on all cores; equal parameters give equal results, however many
/// cores there are. Errors: what cannot be simulated.
Result<FaultTable> run_faults(const FaultsParams& params, const std::function<void(double)>& progress);

}  // namespace tactus::experiments
