#pragma once

#include <tactus/cli/site_loop.hpp>
#include <tactus/runtime/servo_thread.hpp>
#include <tactus/simulation/experiment.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace tactus::cli {

/// The head of the lines that `second_line` makes.
std::string second_head(const std::string& site);
/// One second in one line.
std::string second_line(const SiteSecond& second);

/// All of a run for every reader: tables, one JSON document, a report with the link and the force second by second.
simulation::Outcome site_outcome(const std::string& site, const SiteTotals& totals,
                                 const std::vector<SiteSecond>& seconds, const runtime::ServoReport& servo,
                                 const simulation::Request& request, std::string_view configuration);

}  // namespace tactus::cli
