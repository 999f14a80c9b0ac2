// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/interfaces/cli/output_folder.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

namespace fs = std::filesystem;

bool is_number(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// `figure-12.svg` of `figure-` and `.svg`.
bool is_numbered(std::string_view name, std::string_view before, std::string_view after) {
  return name.size() > before.size() + after.size() && name.starts_with(before) && name.ends_with(after) &&
         is_number(name.substr(before.size(), name.size() - before.size() - after.size()));
}

bool is_of_a_report(const std::string& name) {
  return name == "report.html" || name == "results.json" || is_numbered(name, "figure-", ".svg");
}

bool is_of_a_log(const std::string& name) {
  return name == "log.mcap" || name == "metadata.yaml" || is_numbered(name, "log_", ".mcap");
}

/// What verbs write beside a report, and what of it a killed run leaves.
bool is_of_a_run(const fs::path& path, const std::vector<std::string>& own_files) {
  static constexpr std::array others{
      "advice.toml",    "arm.urdf", "armatures.toml", "estimated_force.csv", "external_torque.csv", "map.csv",
      "map.h5",         "map.svg",  "model.toml",     "recording.csv",       "response.csv",        "rig.toml",
      "trajectory.csv", "log"};
  const std::string name = path.filename().string();
  return is_of_a_report(name) || path.extension() == ".partial" || std::ranges::find(others, name) != others.end() ||
         std::ranges::find(own_files, name) != own_files.end();
}

/// Whether both are there and the same.
bool is_same(const fs::path& one, const char* other) {
  std::error_code ignored;
  return other != nullptr && *other != '\0' && fs::equivalent(one, other, ignored);
}

Error refused(std::string message, std::string place) {
  return {.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = std::move(place)};
}

Error is_a_link(const fs::path& path, const std::string& place) {
  return refused(
      "'" + path.string() + "' is a symbolic link, which is never followed: remove it, or name another place", place);
}

/// The folder as it is looked at: `out/` and `out/.` are `out`, so that a link shows as one.
fs::path without_slash(const fs::path& folder) {
  const fs::path normal = folder.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

bool is_link(const fs::path& path) {
  std::error_code ignored;
  return fs::is_symlink(fs::symlink_status(without_slash(path), ignored));
}

}  // namespace

void add_output_options(CLI::App& verb, OutputOptions& options, const std::string& command, const std::string& help) {
  CLI::Option* out = verb.add_option("--out", options.folder, help)->type_name("DIR");
  verb.add_flag("--overwrite", options.overwrite, "Replace the files of an earlier run")->needs(out);
  add_json_option(verb, options.json, command);
}

void add_log_limit_option(CLI::App& verb, std::uint64_t& most_bytes) {
  verb.add_option("--log-limit", most_bytes,
                  "Size limit of the log on disk, such as 500MB or 2GB; by default unlimited. The log has up to four "
                  "parts. When the newest part is full, the oldest is deleted")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->check([](const std::string& bytes) -> std::string {
        const double least = static_cast<double>(telemetry::LogWriter::least_limit_bytes);
        return std::strtod(bytes.c_str(), nullptr) < least ? "is too little for a log: allow it 8 MiB or more" : "";
      })
      ->needs("--out");
}

Check may_write(const fs::path& file, bool overwrite, const std::string& place) {
  if (is_link(file)) return is_a_link(file, place);
  std::error_code ignored;
  if (overwrite || !fs::is_regular_file(fs::symlink_status(file, ignored))) return std::nullopt;
  return refused("'" + file.string() + "' is there already: name another file, or add --overwrite to replace it",
                 place);
}

Result<OutputFolder> OutputFolder::open(const OutputOptions& options) {
  OutputFolder output(options);
  if (!output.wanted()) return output;
  if (options.folder->empty()) {
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = "no folder is named: write one, as in --out results",
                 .place = "--out"};
  }
  if (auto error = output.check()) return *std::move(error);
  fs::path there = output.path();
  std::error_code ignored;
  while (there.has_relative_path() && !fs::exists(there, ignored)) there = there.parent_path();
  if (auto error = report::prepare_directory(there.empty() ? "." : there)) return *std::move(error);
  return output;
}

std::vector<fs::path> OutputFolder::left() const {
  std::vector<fs::path> found;
  std::error_code ignored;
  const auto is_folder = [](const fs::directory_entry& entry) {  // which no run makes under such a name
    std::error_code unknown;
    return fs::is_directory(entry.symlink_status(unknown));
  };
  for (const auto& entry : fs::directory_iterator(path(), ignored)) {
    const std::string name = entry.path().filename().string();
    const bool own = std::find(options_.own_files.begin(), options_.own_files.end(), name) != options_.own_files.end();
    if ((own || is_of_a_report(name)) && !is_folder(entry)) found.push_back(entry.path());
  }
  for (const auto& entry : fs::directory_iterator(log_folder(), ignored)) {
    if (is_of_a_log(entry.path().filename().string()) && !is_folder(entry)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Refuses a folder in which results would stand among the files of others. One that an earlier report shows to be for
/// results may hold more.
Check OutputFolder::refuse_shared() const {
  const auto shared = [this](const std::string& why) {
    return refused("'" + path().string() + "' " + why +
                       ": name a folder of its own, one that is not there yet or is empty, as " +
                       (path() / "results").string(),
                   "--out");
  };
  if (is_same(path(), "/")) return shared("is the root of the file system");
  if (is_same(path(), std::getenv("HOME"))) return shared("is your home folder");
  std::error_code ignored;
  if (fs::is_regular_file(fs::symlink_status(path() / "report.html", ignored))) return std::nullopt;
  std::string foreign;
  for (const auto& entry : fs::directory_iterator(path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!is_of_a_run(entry.path(), options_.own_files) && (foreign.empty() || name < foreign)) foreign = name;
  }
  if (foreign.empty()) return std::nullopt;
  return shared("holds other files, as '" + report::printable(foreign) + "'");
}

Check OutputFolder::check() const {
  for (const fs::path& folder : {path(), log_folder()}) {
    if (is_link(folder)) return is_a_link(folder, "--out");
  }
  const std::vector<fs::path> old = left();
  for (const fs::path& file : old) {
    if (is_link(file)) return is_a_link(file, "--out");
  }
  if (Check error = refuse_shared()) return error;
  for (const fs::path& file : old) {
    if (options_.overwrite) break;
    return refused("'" + file.string() +
                       "' is there already, of an earlier run: name another folder, or add --overwrite to replace all "
                       "that it left there",
                   "--out");
  }
  return std::nullopt;
}

Check OutputFolder::begin() {
  if (begun_) return std::nullopt;
  if (auto error = check()) return error;
  for (const fs::path& file : left()) {
    std::error_code failed;
    if (fs::remove(file, failed); failed) {
      return Error{.code = ErrorCode::unwritable,
                   .parameter = {},
                   .message = "'" + file.string() + "' of an earlier run cannot be removed (" + failed.message() +
                              "): change its folder's permissions, or name another folder",
                   .place = "--out"};
    }
  }
  if (auto error = report::prepare_directory(path())) return error;
  begun_ = true;
  return std::nullopt;
}

Check OutputFolder::write(const std::string& name, std::string_view content) {
  if (auto error = begin()) return error;
  return report::write_file(path() / name, content);
}

std::string OutputFolder::report_line() const { return "Report: " + (path() / "report.html").string() + "\n"; }

std::string OutputFolder::log_line(std::uint64_t removed) const {
  std::string line = "Log: " + log_folder().string();
  if (removed > 0) line += ", without the " + std::to_string(removed) + " oldest records, for --log-limit";
  return line + "\n";
}

void OutputFolder::announce() const { (json() ? message_stream() : result_stream()) << report_line(); }

void OutputFolder::announce_log(std::uint64_t removed) const {
  (json() ? message_stream() : result_stream()) << log_line(removed);
}

}  // namespace tactus::cli
