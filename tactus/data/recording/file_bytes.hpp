// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <filesystem>
#include <string>

namespace tactus::recording {

/// Everything that a regular file holds. Errors: `missing`; `out_of_bounds` for one of more than `most` bytes.
Result<std::string> file_bytes(const std::filesystem::path& file, std::size_t most);

}  // namespace tactus::recording
