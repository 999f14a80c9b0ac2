// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/faults/rows.hpp>
#include <tactus/simulation/experiments/faults/run.hpp>

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

/// How many runs of a row broke a rule, and the number of the first of them.
struct BrokenRule {
  std::string_view rule;
  std::int64_t count = 0;
  std::int64_t first = 0;
};

struct FaultTally {
  /// Failures that are listed one by one; of more only the counts are kept.
  static constexpr std::size_t most_failures = 1000;

  FaultRow row;
  std::int64_t tried = 0;
  std::int64_t survived = 0;
  std::int64_t diverged = 0;
  std::int64_t stopped = 0;
  std::int64_t detected = 0;
  double simulated_s = 0.0;
  std::vector<FaultFailure> failures;  ///< the first `most_failures`
  std::vector<BrokenRule> broken;      ///< of all failures, by rule in alphabetical order
  FaultOutcome worst{};                ///< sums of the counts, largest of the rest
  double time_to_stop_median_s = 0.0;
  double time_to_stop_most_s = 0.0;
  double detection_ticks_median = 0.0;
  double detection_ticks_most = 0.0;

  /// What shows that the row means something: a control, most of whose runs must not survive.
  [[nodiscard]] bool fails() const { return 2 * survived <= tried; }
};

/// The plans of a row, one after the other: a table never holds all of them.
class PlanSource {
 public:
  /// With `controls` those of its control: the first that can show what is switched off.
  PlanSource(const FaultRow& row, const FaultsParams& params, bool controls)
      : row_(&row), params_(&params), controls_(controls && row.control.shows != nullptr) {}
  FaultPlan next();

 private:
  const FaultRow* row_;
  const FaultsParams* params_;
  bool controls_;
  std::int64_t drawn_ = 0;
};

/// All plans of a row.
std::vector<FaultPlan> draw_plans(const FaultRow& row, const FaultsParams& params);

/// Adds the runs of a row up, in the order of their plans. What it keeps of a run is at most two numbers.
class FaultTallier {
 public:
  /// A run `diverged` in which the master gave more energy than this.
  FaultTallier(const FaultRow& row, double diverged_above_J)
      : sum_{.row = row, .failures = {}, .broken = {}, .worst = {}}, diverged_above_J_(diverged_above_J) {}
  /// `rule` is the one that the run broke, empty where it survived.
  void add(const FaultPlan& plan, const FaultOutcome& outcome, std::string_view rule);
  /// After the last run.
  FaultTally finish() &&;

 private:
  FaultTally sum_;
  double diverged_above_J_;
  std::vector<double> stop_s_, detection_;
};

/// What came of the runs of a row, one outcome for each plan, by the rules of `params`.
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

/// Runs `count` items in parallel, at most `most_runs_at_once` at a time, so that memory does not grow with the count:
/// `prepare(first, size)` makes ready what `run(place)` does for each place below `size`, and `take(place)` adds it up,
/// in order, on this thread.
inline constexpr std::size_t most_runs_at_once = 4096;
void run_in_stretches(std::size_t count, const std::function<void(std::size_t first, std::size_t size)>& prepare,
                      const std::function<void(std::size_t place)>& run,
                      const std::function<void(std::size_t place)>& take, const std::function<void(double)>& progress);

/// Runs the rows and their controls in virtual time on all cores; equal parameters give equal results, however many
/// cores there are. Errors: what cannot be simulated.
Result<FaultTable> run_faults(const FaultsParams& params, const std::function<void(double)>& progress);

}  // namespace tactus::experiments
