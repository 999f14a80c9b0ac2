// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <string>

namespace tactus::cli {

/// Loads a shared object and adds the drivers that it brings (`tactus/hardware/devices/plugin/plugin.hpp`). It stays
/// loaded. Errors: `missing` for a file that cannot be loaded, `inconsistent` for one that is no plug-in or was
/// compiled against another version of tactus; what the plug-in refuses.
Check load_plugin(const std::string& file);

}  // namespace tactus::cli
