// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/entry.hpp>
#include <tactus/kernel/core/result.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace tactus::configuration {

/// The longest text that is read as a configuration. [bytes]
inline constexpr std::size_t longest_document = 1U << 20U;

/// The keys of a TOML text in the order they are written, a section before its keys. Errors: `syntax`, placed at
/// `name:line:column`.
Result<std::vector<Entry>> read_toml(std::string_view text, const std::string& name);

}  // namespace tactus::configuration
