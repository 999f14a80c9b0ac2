// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace tactus::live {

struct StaticFile {
  std::string content;
  std::string type;  ///< MIME type
};

/// The files of a page, read once. What is served later comes from this table alone, so no request can reach any other
/// file.
class StaticFiles {
 public:
  /// No page at all.
  StaticFiles() = default;

  /// Reads a folder with an `index.html` and what lies below it; hidden files and links are left out. Errors: `missing`
  /// where there is no such page or it cannot be read, `out_of_bounds` for more than 1000 files or 64 MiB.
  static Result<StaticFiles> load(const std::filesystem::path& folder);

  /// The file that a request's target (`/assets/page.js?x`) asks for, or null.
  [[nodiscard]] const StaticFile* find(std::string_view target) const;
  [[nodiscard]] bool empty() const { return files_.empty(); }

 private:
  std::map<std::string, StaticFile, std::less<>> files_;  ///< by path: `/index.html`
};

}  // namespace tactus::live
