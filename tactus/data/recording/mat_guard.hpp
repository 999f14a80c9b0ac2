// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <filesystem>

namespace tactus::recording {

/// Checks that a file is a MATLAB file of version 5 and that every size in it fits what is really there, and returns
/// the number of its variables.
///
/// matio trusts such sizes in places, so a file goes to matio only after it has passed. Compressed variables are
/// inflated to check them, their check sums included, as far as `limits.hpp` allows: a variable that claims more is
/// refused (`out_of_bounds`) before it is unpacked. Source: MathWorks, MAT-File Format, chapter 1 (Level 5 MAT-files).
Result<std::size_t> check_mat_file(const std::filesystem::path& file);

}  // namespace tactus::recording
