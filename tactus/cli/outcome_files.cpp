#include <tactus/cli/outcome_files.hpp>
#include <tactus/cli/standard_output.hpp>
#include <tactus/report/figure.hpp>
#include <tactus/report/files.hpp>

#include <filesystem>
#include <iostream>
#include <system_error>

namespace tactus::cli {

Check check_writable(const std::string& folder) {
  if (folder.empty()) {
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = "no folder is named: write one, as in --out results",
                 .place = "--out"};
  }
  std::filesystem::path there = folder;
  std::error_code ignored;
  while (there.has_relative_path() && !std::filesystem::exists(there, ignored)) there = there.parent_path();
  return report::prepare_directory(there.empty() ? "." : there);
}

Check write_results(const std::filesystem::path& folder, const simulation::Outcome& outcome) {
  if (auto error = report::prepare_directory(folder)) return error;
  for (std::size_t i = 0; i < outcome.figures.size(); ++i) {
    const auto path = folder / ("figure-" + std::to_string(i + 1) + ".svg");
    if (auto error = report::write_file(path, report::to_svg(outcome.figures[i]))) return error;
  }
  if (auto error = report::write_file(folder / "results.json", outcome.json)) return error;
  return report::write_file(folder / "report.html", outcome.html);
}

Check write_outcome(const std::optional<std::string>& out, const simulation::Outcome& outcome, bool json) {
  if (out) {
    if (auto error = write_results(*out, outcome)) return error;
  }
  std::cout << (json ? outcome.json : outcome.text);
  if (auto error = flush_standard_output()) return error;
  if (!out) return std::nullopt;
  (json ? std::cerr : std::cout) << "Report: " << (std::filesystem::path(*out) / "report.html").string() << "\n";
  return std::nullopt;
}

}  // namespace tactus::cli
