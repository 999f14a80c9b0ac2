// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace tactus::cli {

/// Where a log comes from: version of tactus, system and processor family. No name of the machine: logs are passed on.
std::map<std::string, std::string> log_origin();

/// Writes the traces of an outcome as a log: `folder/log.mcap`, with `metadata.yaml` for ROS 2 bag tools. One trace is
/// the topic `/teleoperator`, several are `/run_1/teleoperator` and so on, by the row of the table; of more than 64,
/// 64 evenly chosen ones. Times are virtual and nothing of the moment is written, so equal runs leave equal bytes.
/// `most_bytes` as in `LogWriter::create`.
Check write_run_log(const std::filesystem::path& folder, const experiments::Request& request,
                    const experiments::Outcome& outcome, std::uint64_t most_bytes);

}  // namespace tactus::cli
