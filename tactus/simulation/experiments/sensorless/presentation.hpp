// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/simulation/experiments/sensorless/sensorless.hpp>

#include <string>
#include <vector>

/// The results of `sensorless` for people and programs. `scores` has one entry for each of `rows`, which are those of
/// `sensorless_cases(params)`.
namespace tactus::experiments {

report::Table sensorless_table(const std::vector<SensorlessCase>& rows, const std::vector<SensorlessScore>& scores,
                               const SensorlessParams& params);
/// One sentence for each delay and each state of cancellation: what sensor and estimates allow, and what prediction
/// does.
std::vector<std::string> sensorless_verdicts(const std::vector<SensorlessCase>& rows,
                                             const std::vector<SensorlessScore>& scores,
                                             const SensorlessParams& params);
report::Figure sensorless_figure(const std::vector<SensorlessCase>& rows, const std::vector<SensorlessScore>& scores,
                                 const SensorlessParams& params);
std::string sensorless_json(const std::string& experiment, const std::vector<SensorlessCase>& rows,
                            const std::vector<SensorlessScore>& scores, const SensorlessParams& params);

}  // namespace tactus::experiments
