// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <string>
#include <string_view>

namespace tactus::configuration {

/// A configuration in TOML, such as `to_toml` writes, as a JSON object: a section is an object, in the order written.
/// `inf` and `nan`, which JSON has not, are texts; so is the kind of what no parameter has (an array, a date).
///
/// Errors: `syntax` for text that is not TOML.
Result<std::string> json_of_toml(std::string_view toml);

}  // namespace tactus::configuration
