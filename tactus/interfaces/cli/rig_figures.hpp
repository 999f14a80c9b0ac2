// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>

#include <filesystem>
#include <optional>

namespace tactus::cli {

/// What the joints of a pair did in a run, from its closed log: positions of leader and follower; tracking error, which
/// is the position that the follower was commanded less the one that it has; and the external torque, if the follower
/// estimates or measures it. None where the log cannot be read, or does not fit into memory at once.
std::optional<report::Figure> joints_figure(const std::filesystem::path& log, const devices::RigPair& pair);

}  // namespace tactus::cli
