// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/real_time/real_time_tapping.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

/// What taps in real time have in common, whether one axis taps or two arms.
namespace tactus::real_time {

/// Refuses more than `most_real_time_taps`.
Check refuse_many_taps(std::size_t taps);

/// How far a run came whose end was asked for.
struct Interrupted {
  std::size_t taps = 0;  ///< that came to their end
  std::size_t of = 0;
};

/// What became of time and of the log.
struct KeptTime {
  std::vector<runtime::ServoReport> runs;  ///< of each run that is shown
  runtime::ServoReport all;
  std::optional<Interrupted> interrupted{};
  Check log{};
};

/// The taps as their experiment shows them.
struct ShownTaps {
  std::string verdict;
  report::Table table;
  std::string json;
  report::Page page;                    ///< but for its end
  std::vector<report::Figure> figures;  ///< those of the page, with that of time
};

/// Says of the taps how time was kept, how far they came, and where their devices were simulated.
RealTimeOutcome real_time_outcome(const experiments::Request& request, const std::string& configuration,
                                  const std::optional<PlantChoice>& plant, ShownTaps shown, KeptTime kept);

/// The kind `arm-tapping`. As `run_in_real_time`.
Result<RealTimeOutcome> run_arms_in_real_time(const experiments::Request& request, const RealTimeOptions& options,
                                              const experiments::Progress& progress);

}  // namespace tactus::real_time
