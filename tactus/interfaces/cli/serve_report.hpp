// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/server.hpp>
#include <tactus/interfaces/live/session_history.hpp>
#include <tactus/interfaces/live/settings.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <string_view>
#include <vector>

namespace tactus::cli {

/// The report of a session of `tactus serve` when it is over.
struct ServeSession {
  double duration_s = 0.0;  ///< of the loops
  live::ServerCounts server;
  std::uint64_t lost_ticks = 0;  ///< that the view came too late for; the log has them
};

/// All of a session for every reader: what was tried, what became of each contact, who came. `parameters` describes
/// those of the history.
experiments::Outcome serve_outcome(const ServeSession& session, const live::SessionHistory& history,
                                   const std::vector<live::ParameterDescription>& parameters,
                                   const experiments::Request& request, std::string_view configuration);

}  // namespace tactus::cli
