// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace tactus::report {

/// Writes `content` to the file `path`, all or nothing: into a temporary file in the same folder, which then takes the
/// name. A reader sees the old file or the new one, and on failure the old file is untouched and no temporary file is
/// left. Refuses to replace anything that is not a regular file (a folder, a device such as /dev/null).
/// Blocks on the disk: never on the servo path.
/// Errors: `unwritable`, with path, reason and remedy in the message.
Check write_file(const std::filesystem::path& path, std::string_view content);

/// The same of a file that is there: it keeps its mode and its owner, and old or new content is on the disk even after
/// a power failure. Errors: also where the owner cannot be kept, for the file is another user's.
Check rewrite_file(const std::filesystem::path& path, std::string_view content);

/// The same for a library that writes files by their name: `write` is given that of the temporary file, which is there
/// and empty, and returns whether it could.
Check replace_file(const std::filesystem::path& path, const std::function<bool(const std::string& temporary)>& write);

/// Makes the folder `path` and its parents where they are missing, and proves by a probe file, removed again, that
/// files can be written there. Called before long work, so that a wrong place is known at the start and not at the end.
/// Errors: `unwritable`, with path, reason and remedy in the message.
Check prepare_directory(const std::filesystem::path& path);

}  // namespace tactus::report
