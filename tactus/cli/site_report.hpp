#pragma once

#include <tactus/cli/site_loop.hpp>
#include <tactus/experiments/experiment.hpp>
#include <tactus/runtime/servo_thread.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::cli {

/// The head of the lines that `second_line` makes.
std::string second_head(control::SiteRole role);
/// One second in one line.
std::string second_line(const SiteSecond& second);

/// All that is known of a run when it is over.
struct SiteRun {
  control::SiteRole role = control::SiteRole::master;
  SiteTotals totals;
  std::vector<SiteSecond> seconds;
  runtime::ServoReport servo;
  std::optional<std::uint64_t> log_dropped;  ///< records that the log had no room for; nothing where there is no log
  std::string ended_by;                      ///< the signal, or what else ended it
  std::uint64_t lines_dropped = 0;           ///< that found nobody reading
};

/// All of a run for every reader: tables, one JSON document, a report with states, link and force second by second.
experiments::Outcome site_outcome(const SiteRun& run, const experiments::Request& request,
                                  std::string_view configuration);

}  // namespace tactus::cli
