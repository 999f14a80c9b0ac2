// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>

#include <string>
#include <vector>

/// The contest's results for people and programs. `scores` has one entry for each of `contest_methods()`.
namespace tactus::experiments {

/// Which method allows the largest gain, in a sentence.
std::string contest_verdict(const std::vector<MethodScore>& scores, const ContestParams& params);
report::Table contest_table(const std::vector<MethodScore>& scores, const ContestParams& params);
report::Figure contest_figure(const std::vector<MethodScore>& scores, const ContestParams& params);
std::string contest_json(const std::string& experiment, const std::vector<MethodScore>& scores,
                         const ContestParams& params);

}  // namespace tactus::experiments
