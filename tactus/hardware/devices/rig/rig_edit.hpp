// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::devices {

/// A joint's offset as it is to be written.
struct NewOffset {
  std::string joint;  ///< its section
  double offset_rad = 0.0;
};

/// The text of a rig file with this offset, to a millionth of a radian; all else stays as it was, comments and layout
/// too. Where none was written, it is written below the joint's `motor`. Errors: those of `Rig::parse`; `inconsistent`
/// where `motor` does not are on a line of its own.
Result<std::string> with_offset(std::string_view text, const std::string& name, const NewOffset& offset);

/// Writes these offsets into the file, all or none: a reader sees the old file or the new one, also after a power
/// failure. The file keeps its mode and its owner. A symbolic link is not followed. Errors: those of `with_offset`;
/// `missing` for a file that cannot be read; `unwritable`.
Check write_offsets(const std::filesystem::path& file, const std::vector<NewOffset>& offsets);

}  // namespace tactus::devices
