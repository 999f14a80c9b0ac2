#pragma once

#include <tactus/experiments/contest/contest.hpp>
#include <tactus/report/figure.hpp>
#include <tactus/report/table.hpp>

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
