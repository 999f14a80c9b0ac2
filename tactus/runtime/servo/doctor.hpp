// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/servo/machine_facts.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>

#include <optional>
#include <string>
#include <vector>

namespace tactus::runtime {

/// What a finding means for a loop with a deadline.
enum class Fitness {
  good,
  unknown,  ///< the system does not report it
  poor,     ///< the loop runs, later or less surely than it could
  bad       ///< ticks will be late
};
constexpr auto enumerators(Fitness) {
  return std::array{Enumerator{Fitness::good, "good"}, Enumerator{Fitness::unknown, "unknown"},
                    Enumerator{Fitness::poor, "poor"}, Enumerator{Fitness::bad, "bad"}};
}

/// One thing that was looked at.
struct Finding {
  std::string name;   ///< `scheduler`
  std::string found;  ///< `SCHED_FIFO priority 80 granted`
  Fitness verdict = Fitness::unknown;
  std::string means;   ///< one sentence
  std::string remedy;  ///< command that fixes it; empty where nothing is to be corrected
};

/// How well a servo thread with an empty step kept time, and what was taken away meanwhile.
struct Measurement {
  ServoReport report;
  std::optional<double> stolen_fraction;  ///< of the time of all cores, by a hypervisor
};

/// Runs a servo thread with an empty step for `duration_s`. Errors: those of the servo thread.
Result<Measurement> measure_lateness(const ServoThreadParams& params, double duration_s);

/// Judges each fact, in the order in which they matter.
std::vector<Finding> diagnose(const MachineFacts& facts, const Measurement& measurement);

/// Whether a loop with a deadline can be run: nothing is bad.
bool can_keep_time(const std::vector<Finding>& findings);

}  // namespace tactus::runtime
