// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tactus::cli {

/// The version, and how the command was built: compiler, kind of build, assertions, sanitizers.
std::string version_text();

}  // namespace tactus::cli
