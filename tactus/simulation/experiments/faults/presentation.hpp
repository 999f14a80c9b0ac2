// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/faults/experiment.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace tactus::experiments {

/// What reports state of the runs in addition to their results.
struct FaultsShown {
  std::string kind;                 ///< of the experiment
  std::string subject;              ///< a paragraph: what was run, and who judged it
  std::int64_t seeds = 0;           ///< runs of each fault
  double rate_Hz = 0.0;             ///< of the sites' ticks
  double rate_limit_N_per_s = 0.0;  ///< of the leading site's gate; N m/s of arms
  std::string configuration;        ///< all keys, as TOML
  std::string motors_give = "N";    ///< unit of what a motor gives
};

/// What came of the faults, for every reader, whatever they were tried on.
Outcome present_faults(const Request& request, const FaultsShown& shown, const FaultTable& table,
                       const std::optional<FaultsInRealTime>& real_time);

}  // namespace tactus::experiments
