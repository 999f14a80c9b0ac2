#pragma once

#include <tactus/core/result.hpp>

#include <filesystem>
#include <string>

namespace tactus::recording {

/// Everything that a regular file holds.
Result<std::string> file_bytes(const std::filesystem::path& file);

}  // namespace tactus::recording
