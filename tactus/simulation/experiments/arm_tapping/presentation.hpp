// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <string>
#include <vector>

/// Taps through two arms for every reader, whatever clock they ran on.
namespace tactus::experiments {

/// An ensemble as it is shown.
struct ArmTappingRun {
  Settings settings;
  ArmTappingMetrics metrics;
};

/// A row for each run; there may be no row.
report::Table arm_table(const std::vector<ArmTappingRun>& runs);

/// Which runs settle, in a sentence.
std::string arm_verdict(const std::vector<ArmTappingRun>& runs);

/// `{"experiment": ..., "runs": [{"set": ..., "metrics": ...}]}`
std::string arm_json(const Request& request, const std::vector<ArmTappingRun>& runs);

/// Forces and tools over the first tap of an ensemble; and both arms on the surface, where it came to that.
std::vector<report::Figure> arm_figures(const Settings& settings, const ArmTaps& taps, const ArmTrace& first);

/// The report but for its end, `add_provenance`; it begins with the verdict.
report::Page arm_page(const Request& request, const std::string& verdict, const report::Table& table,
                      const std::vector<report::Figure>& figures);

}  // namespace tactus::experiments
