// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/simulation/experiments/arm_contest/arm_contest.hpp>

#include <string>
#include <vector>

/// The contest's results for people and programs. `scores` has one for each of `contest`'s entries.
namespace tactus::experiments {

/// Which methods to use on each pair, a sentence each.
std::string arm_contest_verdict(const ArmContest& contest, const std::vector<ArmContestScore>& scores,
                                const ArmContestTask& task);
report::Table arm_contest_table(const ArmContest& contest, const std::vector<ArmContestScore>& scores,
                                const ArmContestTask& task);
report::Figure arm_contest_figure(const ArmContest& contest, const std::vector<ArmContestScore>& scores,
                                  const ArmContestTask& task);
std::string arm_contest_json(const std::string& experiment, const ArmContest& contest,
                             const std::vector<ArmContestScore>& scores, const ArmContestTask& task);

}  // namespace tactus::experiments
