// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/static_files.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>
#include <utility>

namespace tactus::live {

namespace {

constexpr std::size_t most_files = 1000;
constexpr std::uintmax_t most_bytes = std::uintmax_t{64} * 1024 * 1024;

std::string type_of(const std::filesystem::path& file) {
  constexpr std::array<std::pair<std::string_view, const char*>, 12> types{{{".html", "text/html; charset=utf-8"},
                                                                            {".js", "text/javascript; charset=utf-8"},
                                                                            {".css", "text/css; charset=utf-8"},
                                                                            {".json", "application/json"},
                                                                            {".svg", "image/svg+xml"},
                                                                            {".png", "image/png"},
                                                                            {".ico", "image/vnd.microsoft.icon"},
                                                                            {".woff2", "font/woff2"},
                                                                            {".wasm", "application/wasm"},
                                                                            {".txt", "text/plain; charset=utf-8"},
                                                                            {".map", "application/json"},
                                                                            {".webmanifest", "application/json"}}};
  const std::string end = file.extension().string();
  const auto* const found =
      std::find_if(types.begin(), types.end(), [&end](const auto& one) { return one.first == end; });
  return found == types.end() ? "application/octet-stream" : found->second;
}

Error bad_page(ErrorCode code, const std::filesystem::path& folder, const std::string& why) {
  return Error{.code = code,
               .parameter = {},
               .message = why + ": name the folder that the build of the page left, with its index.html",
               .place = folder.string()};
}

}  // namespace

Result<StaticFiles> StaticFiles::load(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  StaticFiles page;
  std::uintmax_t bytes = 0;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const bool hidden = entry->path().filename().string().starts_with('.');
    if (hidden && entry->is_directory(error)) entry.disable_recursion_pending();
    if (hidden || entry->is_symlink(error) || !entry->is_regular_file(error)) continue;
    const std::uintmax_t size = entry->file_size(error);
    if (error) break;
    bytes += size;
    if (page.files_.size() == most_files || bytes > most_bytes) {
      return bad_page(ErrorCode::out_of_bounds, folder, "holds more than 1000 files or 64 MiB and cannot be a page");
    }
    std::ifstream file(entry->path(), std::ios::binary);
    std::string content(static_cast<std::size_t>(size), '\0');
    if (!file.read(content.data(), static_cast<std::streamsize>(content.size())))
      return bad_page(ErrorCode::missing, entry->path(), "cannot be read");
    std::string name = "/";
    name += entry->path().lexically_relative(folder).generic_string();
    page.files_[name] = {std::move(content), type_of(entry->path())};
  }
  if (error) return bad_page(ErrorCode::missing, folder, "cannot be read (" + error.message() + ")");
  if (!page.files_.contains("/index.html")) return bad_page(ErrorCode::missing, folder, "holds no index.html");
  return page;
}

const StaticFile* StaticFiles::find(std::string_view target) const {
  const std::string_view path = target.substr(0, target.find_first_of("?#"));
  const auto found = files_.find(path == "/" ? "/index.html" : path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace tactus::live
