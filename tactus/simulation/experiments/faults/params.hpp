// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/faults/harm_bounds.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <array>
#include <cstdint>
#include <string>

/// What the table of faults is run with.
namespace tactus::experiments {

enum class FaultsKind { faults };
constexpr auto enumerators(FaultsKind) { return std::array{Enumerator{FaultsKind::faults, "faults"}}; }

struct FaultsTask {
  FaultsKind kind = FaultsKind::faults;
  std::int64_t seeds = 1000;
  std::int64_t seed = 1;
  std::string only;
  double longest_cut_s = 60.0;
  double light_grip_fraction = 0.1;
  double diverged_above_J = 0.25;
  HarmBounds bounds;
  std::int64_t real_time_seeds = 30;
  static constexpr auto fields() {
    return List{field("kind", &FaultsTask::kind, "Kind of the experiment."),
                field("seeds", &FaultsTask::seeds, between(1, 1000000), "Number of runs of each fault."),
                field("seed", &FaultsTask::seed, non_negative, "Seed from which every run is drawn."),
                field("only", &FaultsTask::only, "Identifier of the only fault to run; empty: all."),
                field("longest_cut_s", &FaultsTask::longest_cut_s, units::second, between(0.02, 600.0),
                      "Longest interruption of the link."),
                field("light_grip_fraction", &FaultsTask::light_grip_fraction, units::none, between(0.01, 1.0),
                      "Damping of the light grip divided by that of the operator."),
                field("diverged_above_J", &FaultsTask::diverged_above_J, units::joule, positive,
                      "A run counts as diverged if the master's motor delivered more energy than this."),
                field("bounds", &FaultsTask::bounds, "Limits of the effects of a fault on people."),
                field("real_time_seeds", &FaultsTask::real_time_seeds, between(1, 1000),
                      "Number of runs of each fault in real time, with --realtime. These runs repeat the first of the "
                      "virtual-time runs; no interruption of the link is longer than one second.")};
  }
};

/// A teleoperator with tight limits. The defaults are what `tactus faults` runs.
struct FaultsParams : simulation::Teleoperator::Params {
  FaultsTask task;
  FaultsParams();
  static constexpr auto fields() {
    return joined(simulation::Teleoperator::Params::fields(), List{field("task", &FaultsParams::task, "The faults.")});
  }
};

}  // namespace tactus::experiments
