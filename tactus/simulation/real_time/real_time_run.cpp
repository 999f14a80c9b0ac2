// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/real_time/internal/real_time_run.hpp>

#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::real_time {

namespace {

std::string text_of(const Interrupted& interrupted) {
  return "Interrupted: " + std::to_string(interrupted.taps) + " of " + std::to_string(interrupted.of) +
         " taps had come to their end, and the table has no other.";
}

std::string json_of(const std::string& of_taps, const std::optional<PlantChoice>& plant, const KeptTime& kept) {
  auto document = report::parse_json<nlohmann::ordered_json>(of_taps);
  document["clock"] = "real";
  if (plant) document["plant"] = plant->name;
  if (kept.interrupted) document["interrupted"] = {{"taps", kept.interrupted->taps}, {"of", kept.interrupted->of}};
  for (std::size_t i = 0; i < kept.runs.size(); ++i) {
    document["runs"][i]["servo"] = report::parse_json<nlohmann::ordered_json>(servo_json(kept.runs[i]));
  }
  return report::json_text(document);
}

/// What the system refused, in words.
std::string losses_of(const runtime::ServoReport& report) {
  std::string text;
  for (const runtime::Right& right : report.rights) {
    if (right.held) continue;
    text +=
        "Not granted: " + right.what + " (" + right.why + "): " + right.means + ".\n    remedy: " + right.remedy + "\n";
  }
  return text;
}

}  // namespace

Check refuse_many_taps(std::size_t taps) {
  if (taps <= most_real_time_taps) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "task.taps",
               .message = std::to_string(taps) + " taps in real time are more than " +
                          std::to_string(most_real_time_taps) + ": ask for fewer, or for virtual time",
               .place = {}};
}

RealTimeOutcome real_time_outcome(const experiments::Request& request, const std::string& configuration,
                                  const std::optional<PlantChoice>& plant, ShownTaps shown, KeptTime kept) {
  const report::Table timing = timing_table(kept.all);
  const report::Table late = late_ticks_table(kept.all);
  const std::string interrupted = kept.interrupted ? text_of(*kept.interrupted) : "";
  report::Page& page = shown.page;
  if (kept.interrupted) page.paragraph(interrupted);
  page.heading("How time was kept");
  page.paragraph(
      std::string("The sites ran on a servo thread at deadlines of the real clock, the devices were simulated ") +
      (plant ? "in the process of the plant '" + plant->name + "'." : "in the same thread."));
  page.table(timing);
  page.table(late);
  page.table(rights_table(kept.all));
  experiments::add_provenance(page, request, configuration);
  return {
      .outcome = {.text = shown.verdict + "\n\n" + (kept.interrupted ? interrupted + "\n\n" : "") +
                          shown.table.to_text() + "\n" + timing.to_text() + "\n" + late.to_text() + losses_of(kept.all),
                  .json = json_of(shown.json, plant, kept),
                  .html = page.to_html(),
                  .figures = std::move(shown.figures),
                  .traces = {},
                  .configuration = configuration},
      .log = std::move(kept.log),
      .interrupted = kept.interrupted.has_value()};
}

}  // namespace tactus::real_time
