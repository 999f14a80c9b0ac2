// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// How tactus measures speed: everything that is compared runs interleaved in one process, and what counts are the
/// ratios of that run. A shared machine drifts by tens of percent within minutes, so times alone mean little.
namespace tactus::bench {

/// CPU times of one pass of each case, in seconds, by the name of the case: the median over all repetitions.
using Times = std::map<std::string, double>;

/// Registers a case with Google Benchmark. A pass does the same work every time and takes 10 µs to 100 ms.
void add_case(const std::string& name, std::function<void()> pass);

/// Runs every case `repetitions` times, for at least `least_time_s` each, in random order.
Times run_cases(int repetitions, double least_time_s);

/// One number of the report. Without a goal it is there to be looked at.
struct Finding {
  enum class Goal { none, at_most, at_least };
  std::string section;
  std::string name;
  double value = 0.0;
  std::string unit = {};
  Goal goal = Goal::none;
  double bound = 0.0;

  [[nodiscard]] bool reached() const {
    return goal == Goal::none || (goal == Goal::at_most ? value <= bound : value >= bound);
  }
};

using Findings = std::vector<Finding>;

}  // namespace tactus::bench
