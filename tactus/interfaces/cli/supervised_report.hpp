// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/runtime/servo/site_loop.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::cli {

/// What runs under supervision here: one site of two, or both.
struct SitesHere {
  std::optional<control::SiteRole> one;  ///< none for both

  [[nodiscard]] bool has(control::SiteRole role) const { return !one || *one == role; }
  /// `the master`, or `both sites`.
  [[nodiscard]] std::string name() const;
};

/// The head of the lines that `second_line` makes.
std::string second_head(const SitesHere& here);
/// One second of a site in one line.
std::string second_line(const SitesHere& here, const runtime::SiteSecond& second);

/// All that is known of a run when it is over.
struct SupervisedRun {
  struct OfSite {
    control::SiteRole role = control::SiteRole::master;
    runtime::SiteTotals totals;
  };
  SitesHere here;
  std::vector<OfSite> sites;
  std::optional<runtime::LinkTotals> link;  ///< of one site
  std::vector<runtime::SiteSecond> seconds;
  runtime::ServoReport servo;
  std::optional<std::uint64_t> log_dropped;  ///< records that were not written down; nothing where there is no log
  std::string ended_by;                      ///< the signal, or what else ended it
  std::uint64_t lines_dropped = 0;           ///< that found nobody reading
};

/// How a run ended in a fault: site, cause and what its gate latched. Empty where it did not.
std::string fault_of(const SupervisedRun& run);

/// All of a run for every reader, a fault at its end first: tables, one JSON document, a report with states, link and
/// force second by second.
experiments::Outcome supervised_outcome(const SupervisedRun& run, const experiments::Request& request,
                                        std::string_view configuration);

}  // namespace tactus::cli
