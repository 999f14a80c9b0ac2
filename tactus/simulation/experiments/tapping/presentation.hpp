// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/simulation/experiments/tapping/figures.hpp>

#include <string>
#include <vector>

/// Taps for every reader, whatever clock they ran on.
namespace tactus::experiments {

/// A row for each run; there may be no row.
report::Table tapping_table(const std::vector<TappingRun>& runs);

/// Which runs settle, in a sentence.
std::string tapping_verdict(const std::vector<TappingRun>& runs);

/// `{"taps": ..., "settled_fraction": ...}`: what is counted over the taps of a run.
std::string metrics_json(const TappingMetrics& metrics);

/// `{"experiment": ..., "runs": [{"set": ..., "metrics": ...}]}`
std::string tapping_json(const Request& request, const std::vector<TappingRun>& runs);

/// The report but for its end, `add_provenance`; it begins with the verdict.
report::Page tapping_page(const Request& request, const std::string& verdict, const report::Table& table,
                          const std::vector<report::Figure>& figures);

}  // namespace tactus::experiments
