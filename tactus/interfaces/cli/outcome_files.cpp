// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/figure.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <string>

namespace tactus::cli {

Check write_results(OutputFolder& output, const experiments::Outcome& outcome, const std::vector<NamedText>& files) {
  for (const NamedText& file : files) {
    if (auto error = output.write(file.name, file.text)) return error;
  }
  for (std::size_t i = 0; i < outcome.figures.size(); ++i) {
    const std::string name = "figure-" + std::to_string(i + 1) + ".svg";
    if (auto error = output.write(name, report::to_svg(outcome.figures[i]))) return error;
  }
  if (auto error = output.write("results.json", output.document(outcome))) return error;
  return output.write("report.html", outcome.html);
}

Check write_outcome(OutputFolder& output, const experiments::Outcome& outcome, const std::vector<NamedText>& files) {
  if (output.wanted()) {
    if (auto error = write_results(output, outcome, files)) return error;
  }
  result_stream() << (output.json() ? output.document(outcome) : outcome.text);
  if (auto error = flush_standard_output()) return error;
  if (output.wanted()) output.announce();
  return std::nullopt;
}

Check write_outcome(const OutputOptions& options, const experiments::Outcome& outcome,
                    const std::vector<NamedText>& files) {
  auto output = OutputFolder::open(options);
  return output ? write_outcome(*output, outcome, files) : Check(output.error());
}

Check leave_outcome(const experiments::Outcome& outcome, OutputFolder& folder, Check log_error, std::uint64_t removed,
                    LineWriter& output, LineWriter& errors) {
  std::string where;
  if (folder.wanted()) {
    if (auto error = write_results(folder, outcome)) return error;
    where = folder.report_line();
    if (!log_error) where += folder.log_line(removed);
  }
  const Check unread = output.finish(folder.json() ? folder.document(outcome) : outcome.text + where);
  if (folder.json()) errors.say(where);
  if (!folder.wanted()) return unread;
  if (unread) errors.say("tactus: " + describe(*unread) + "; the report has all of it\n");
  return log_error;
}

Error ended_in_a_fault(const std::string& fault, Check unwritten, LineWriter& errors) {
  if (unwritten) errors.say("tactus: " + describe(*unwritten) + "\n");
  return {.code = ErrorCode::failed, .parameter = {}, .message = "the run ended in a fault: " + fault, .place = {}};
}

}  // namespace tactus::cli
