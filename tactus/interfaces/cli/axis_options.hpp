// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/axis_recording.hpp>
#include <tactus/interfaces/cli/output_folder.hpp>
#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

/// What the commands that read one axis of a recording share.
namespace tactus::cli {

struct AxisOptions {
  std::string file;
  identification::AxisRoles roles;
  OutputOptions output;
};

/// Adds RECORDING, the roles of its columns, `--out` and `--json` to a command.
void add_axis_options(CLI::App& verb, AxisOptions& options, const std::string& command);

/// The recording that the options name, once it is clear that results may be left where they shall be.
Result<identification::AxisRecording> read_axis(const AxisOptions& options, bool needs_measured = false);

}  // namespace tactus::cli
