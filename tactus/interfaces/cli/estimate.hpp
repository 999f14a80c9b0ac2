// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

/// What `tactus estimate` can estimate: each adds one subcommand to `estimate`, as those of identify.hpp do to
/// `identify`.
namespace tactus::cli {

void add_estimate_torque(CLI::App& estimate, const std::string& name, const std::string& command, int& status);

}  // namespace tactus::cli
