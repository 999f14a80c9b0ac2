// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/devices/rig/rig_loop.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::cli {

/// What a run of a rig's pair left, or of one side of it.
struct RigRun {
  std::optional<control::SiteRole> only;    ///< where the other side is elsewhere
  std::optional<runtime::LinkTotals> link;  ///< then
  std::vector<devices::RigSecond> seconds;
  devices::RigSecond last;  ///< the end
  devices::RigTotals totals;
  runtime::ServoReport servo;
  std::string ended_by;  ///< a signal, or its duration
  std::uint64_t lines_dropped = 0;
  std::optional<std::uint64_t> log_dropped;
};

/// A second for a terminal, with what a user does next where there is something; `only` as in `RigRun`.
std::string line_of(const devices::RigSecond& second, const devices::RigPair& pair,
                    std::optional<control::SiteRole> only = {});

/// How a run ended in a fault: the site, the cause and the joint. Empty where it did not.
std::string fault_of(const RigRun& run, const devices::RigPair& pair);

/// The run for every reader, a fault at its end first. `configuration` is TOML; `joints` is a figure of what the joints
/// did, where there is a log.
experiments::Outcome rig_outcome(const RigRun& run, const devices::RigPair& pair, const experiments::Request& request,
                                 std::string_view configuration, const std::optional<report::Figure>& joints);

}  // namespace tactus::cli
