#pragma once

#include <tactus/simulation/fault_run.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

/// The table of faults: many seeded runs of each, and what came of them.
namespace tactus::simulation {

enum class FaultsKind { faults };
constexpr auto enumerators(FaultsKind) { return std::array{Enumerator{FaultsKind::faults, "faults"}}; }

struct FaultsTask {
  FaultsKind kind = FaultsKind::faults;
  std::int64_t seeds = 1000;
  std::int64_t seed = 1;
  double longest_cut_s = 60.0;
  double light_grip_fraction = 0.1;
  double diverged_above_J = 0.25;
  std::int64_t real_time_seeds = 30;
  static constexpr auto fields() {
    return std::tuple{field("kind", &FaultsTask::kind, "Which experiment this is."),
                      field("seeds", &FaultsTask::seeds, between(1, 1000000), "Runs of each fault."),
                      field("seed", &FaultsTask::seed, non_negative, "Seed that draws every plan."),
                      field("longest_cut_s", &FaultsTask::longest_cut_s, units::second, between(0.02, 600.0),
                            "Longest cut of the link."),
                      field("light_grip_fraction", &FaultsTask::light_grip_fraction, units::none, between(0.01, 1.0),
                            "Damping of the light grip over that of the operator."),
                      field("diverged_above_J", &FaultsTask::diverged_above_J, units::joule, positive,
                            "A run in which the master's motor gave more energy than this diverged."),
                      field("real_time_seeds", &FaultsTask::real_time_seeds, between(1, 1000),
                            "Runs of each fault in real time, where that is asked for: the first of those in virtual "
                            "time, no cut longer than a second.")};
  }
};

/// A teleoperator with tight limits. The defaults are what `tactus faults` runs.
struct FaultsParams : Teleoperator::Params {
  FaultsTask task;
  FaultsParams();
  static constexpr auto fields() {
    return std::tuple_cat(Teleoperator::Params::fields(),
                          std::tuple{field("task", &FaultsParams::task, "The faults.")});
  }
};

/// One row: what is done, and what must come of it.
struct FaultRow {
  FaultKind kind;
  std::string_view name;
  std::string_view injected;
  std::string_view expected;
  bool monitored = true;  ///< false: the passivity monitor as loose as its bounds allow
};
std::vector<FaultRow> fault_rows();

/// The parameters of a row: those given, or with the monitor as loose as it can be.
Teleoperator::Params params_of(const FaultRow& row, const FaultsParams& params);

/// The rule that a run broke, in words; empty where it kept everything that its row asks for.
std::string_view broken_rule(const FaultRow& row, const FaultPlan& plan, const FaultOutcome& outcome,
                             const FaultsParams& params);

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
};

/// The plans of a row.
std::vector<FaultPlan> draw_plans(const FaultRow& row, const FaultsParams& params);

/// What came of the runs of a row, one outcome for each plan.
FaultTally tally(const FaultRow& row, const FaultsParams& params, const std::vector<FaultPlan>& plans,
                 const std::vector<FaultOutcome>& outcomes);

/// Runs every row in virtual time on all cores; equal parameters give equal results, however many cores there are.
/// Errors: what cannot be simulated.
Result<std::vector<FaultTally>> run_faults(const FaultsParams& params, const std::function<void(double)>& progress);

}  // namespace tactus::simulation
