// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/recording/time_base.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/frequency_response.hpp>
#include <tactus/interfaces/cli/identify.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using identification::FrequencyResponse;
using identification::InputOutput;

struct FrfOptions {
  std::vector<std::string> files;
  std::string input, output, time, time_unit;
  std::optional<double> sample_time_s;
  std::string method = "h1";
  std::optional<std::int64_t> segment_samples;
  std::int64_t smoothing_lines = 15;
  double lower_Hz = 0.0;
  double upper_Hz = std::numeric_limits<double>::infinity();
  bool compare = false;
  OutputOptions results;
};

struct Pair {
  recording::Signal input, output;
};

struct Estimates {
  Seconds sample_time{0.0};
  std::string how;
  FrequencyResponse response;  ///< of all recordings together
  std::optional<identification::Linearity> linearity;
};

Error inconsistent(std::string message, std::string place) {
  return {ErrorCode::inconsistent, {}, std::move(message), std::move(place)};
}

/// `NAME` or `NAME:COLUMN`, the column counted from 1.
recording::Source source_of(const FrfOptions& options, const std::string& file, const std::string& column) {
  recording::Source source{.file = file, .variable = column, .time = options.time, .time_unit = options.time_unit};
  source.sample_time_s = options.sample_time_s;
  const std::size_t colon = column.rfind(':');
  if (colon == std::string::npos) return source;
  const char* const end = column.data() + column.size();
  std::int64_t number = 0;
  if (std::from_chars(column.data() + colon + 1, end, number).ptr == end) {
    source.variable = column.substr(0, colon);
    source.column = number;
  }
  return source;
}

Result<std::vector<Pair>> read_runs(const FrfOptions& options) {
  std::vector<Pair> runs;
  for (const std::string& file : options.files) {
    auto input = recording::read(source_of(options, file, options.input));
    if (!input) return input.error();
    auto output = recording::read(source_of(options, file, options.output));
    if (!output) return output.error();
    for (const auto* signal : {&*input, &*output}) {
      if (!signal->sample_time_s) {
        return Error{ErrorCode::missing, {}, "the recording states no times; give --sample-time-s", file};
      }
      if (Check wrong = signal->time_unit_stated
                            ? std::nullopt
                            : recording::check_step(*signal->sample_time_s, signal->time_unit_stated)) {
        wrong->place = file;
        return *std::move(wrong);
      }
      const double first_s = runs.empty() ? *input->sample_time_s : *runs.front().input.sample_time_s;
      if (std::abs(*signal->sample_time_s - first_s) > 1e-3 * first_s) {
        return inconsistent("the sample time is " + rounded_number(*signal->sample_time_s) + " s and not " +
                                rounded_number(first_s) + " s as before; only runs of one rate can be put together",
                            file);
      }
    }
    if (input->values.size() != output->values.size()) {
      return inconsistent("'" + options.input + "' has " + std::to_string(input->values.size()) + " samples and '" +
                              options.output + "' " + std::to_string(output->values.size()),
                          file);
    }
    if (const std::string note = recording::jitter_note(input->jitter_s, *input->sample_time_s); !note.empty()) {
      message_stream() << "Note: " << note << "\n";
    }
    runs.push_back({*std::move(input), *std::move(output)});
  }
  return runs;
}

/// The longest segments up to 4096 samples of which the shortest run holds eight.
std::int64_t usual_segment(const std::vector<Pair>& runs) {
  std::size_t shortest = runs.front().input.values.size();
  for (const Pair& run : runs) shortest = std::min(shortest, run.input.values.size());
  return static_cast<std::int64_t>(std::clamp<std::size_t>(std::bit_floor(shortest / 8), 8, 4096));
}

Result<FrequencyResponse> estimate(const FrfOptions& options, std::span<const InputOutput> runs, Seconds sample_time,
                                   std::int64_t segment_samples) {
  if (options.method == "etfe") {
    return identification::etfe(runs, sample_time, {.smoothing_lines = options.smoothing_lines});
  }
  const auto spectra = identification::average_spectra(runs, sample_time, {.samples = segment_samples});
  if (!spectra) return spectra.error();
  auto response = options.method == "h1" ? response_h1(*spectra) : response_h2(*spectra);
  // A coherence that chance alone would show on one of the lines with a probability of 5 %.
  const auto lines = static_cast<double>(response.coherence.size());
  const double chance = 1.0 - std::pow(0.05 / lines, 1.0 / (spectra->independent_segments - 1.0));
  if (std::none_of(response.coherence.begin() + 1, response.coherence.end(),
                   [&](double coherence) { return coherence > chance; })) {
    return inconsistent("the output has nothing to do with the input on any line (coherence below " +
                            report::number(chance, 2) +
                            "): are the columns the right ones, and is the recording long "
                            "enough?",
                        {});
  }
  return response;
}

Result<Estimates> estimate_all(const FrfOptions& options, const std::vector<Pair>& runs) {
  Estimates found{
      .sample_time = Seconds{*runs.front().input.sample_time_s}, .how = {}, .response = {}, .linearity = std::nullopt};
  const std::int64_t segment = options.segment_samples.value_or(usual_segment(runs));
  found.how = options.method == "etfe" ? "ETFE, smoothed over " + std::to_string(options.smoothing_lines) + " lines"
                                       : (options.method == "h1" ? "H1" : "H2") + std::string(", Hann segments of ") +
                                             std::to_string(segment) + " samples that overlap by half";
  std::vector<InputOutput> all;
  for (const Pair& run : runs) all.push_back({run.input.values, run.output.values});
  auto together = estimate(options, all, found.sample_time, segment);
  if (!together) return together.error();
  found.response = *std::move(together);
  if (!options.compare) return found;
  std::vector<FrequencyResponse> each;
  for (std::size_t i = 0; i < all.size(); ++i) {
    auto one = estimate(options, std::span(all).subspan(i, 1), found.sample_time, segment);
    if (!one) return Error{one.error().code, one.error().parameter, one.error().message, options.files[i]};
    each.push_back(*std::move(one));
  }
  auto linearity = judge_linearity(each, options.lower_Hz, options.upper_Hz);
  if (!linearity) return linearity.error();
  found.linearity = *linearity;
  return found;
}

struct Row {
  double frequency_Hz, gain, gain_95, phase_deg, phase_95_deg, coherence;
};

std::vector<Row> rows_of(const FrfOptions& options, const FrequencyResponse& response) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  std::vector<Row> rows;
  for (std::size_t k = 1; k < response.frequency_Hz.size(); ++k) {
    if (response.frequency_Hz[k] < options.lower_Hz || response.frequency_Hz[k] > options.upper_Hz) continue;
    const double gain = std::abs(response.response[k]);
    const double radius = response.radius_95[k];
    rows.push_back({.frequency_Hz = response.frequency_Hz[k],
                    .gain = gain,
                    .gain_95 = radius,
                    .phase_deg = degrees * std::arg(response.response[k]),
                    .phase_95_deg = radius < gain ? degrees * std::asin(radius / gain) : 180.0,
                    .coherence = response.coherence.empty() ? std::nan("") : response.coherence[k]});
  }
  return rows;
}

std::string verdict(const identification::Linearity& linearity) {
  return std::string(linearity.linear ? "Linear" : "Not linear") + ": " + report::number(100.0 * linearity.outside, 2) +
         " % of all pairs of recordings and lines differ by more than "
         "their bands explain (chance alone: about 5 %); median of the largest difference " +
         report::number(100.0 * linearity.spread, 2) + " %, worst at " + report::number(linearity.worst_Hz, 3) + " Hz.";
}

report::Table table_of(const std::vector<Row>& rows, const std::string& unit) {
  report::Table table({{.title = "frequency", .unit = "Hz"},
                       {.title = "gain", .unit = unit},
                       {.title = "± 95 %", .unit = unit},
                       {.title = "phase", .unit = "°"},
                       {.title = "± 95 %", .unit = "°"},
                       {.title = "coherence"}});
  constexpr double ratio = 1.3;
  double next_Hz = 0.0;
  for (const Row& row : rows) {
    if (row.frequency_Hz < next_Hz) continue;
    next_Hz = ratio * row.frequency_Hz;
    table.add_row({report::number(row.frequency_Hz, 4), report::number(row.gain, 4), report::number(row.gain_95, 2),
                   report::number(row.phase_deg, 4), report::number(row.phase_95_deg, 2),
                   report::number(row.coherence, 3)});
  }
  return table;
}

report::Figure figure_of(const std::vector<Row>& rows, const std::string& unit, bool with_coherence) {
  std::vector<double> x, gain, above, below, phase, later, earlier, coherence;
  double before_deg = std::nan("");
  for (const Row& row : rows) {
    x.push_back(row.frequency_Hz);
    gain.push_back(row.gain);
    above.push_back(row.gain + row.gain_95);
    below.push_back(row.gain - row.gain_95);
    // No line across the edge at 180 degrees, and none where the band is the whole circle.
    const bool told = row.phase_95_deg < 180.0;
    const bool wraps = std::abs(row.phase_deg - before_deg) > 180.0;
    before_deg = row.phase_deg;
    const bool drawn = told && !wraps;
    phase.push_back(drawn ? row.phase_deg : std::nan(""));
    later.push_back(drawn ? row.phase_deg - row.phase_95_deg : std::nan(""));
    earlier.push_back(drawn ? row.phase_deg + row.phase_95_deg : std::nan(""));
    coherence.push_back(row.coherence);
  }
  using Scale = report::Axis::Scale;
  const report::Axis frequency{.label = "frequency", .unit = "Hz", .scale = Scale::logarithmic};
  const auto line = [&x](std::string name, const std::vector<double>& y, int colour, double width_px) {
    return report::Line{.name = std::move(name), .x = x, .y = y, .colour = colour, .width_px = width_px};
  };
  const std::string band = "95 % band";
  // The limits follow the response and not a band that tells nothing.
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const double value : gain) {
    if (value > 0.0 && std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
  }
  report::Axis gain_axis{.label = "gain", .unit = unit, .scale = Scale::logarithmic};
  if (most > 0.0) {
    gain_axis.lower = least / 2.0;
    gain_axis.upper = most * 2.0;
  }
  report::Figure figure{.title = "Frequency response",
                        .caption =
                            "Output over input on a logarithmic frequency axis, with the band that holds the "
                            "true response with a probability of 95 %.",
                        .columns = 1,
                        .panels = {},
                        .share_x = report::Sharing::in_line};
  figure.panels.push_back(
      {.title = {},
       .x = frequency,
       .y = gain_axis,
       .lines = {line(band, above, 1, 0.6), line({}, below, 1, 0.6), line("response", gain, 0, 1.4)},
       .rules = {}});
  figure.panels.push_back({.title = {},
                           .x = frequency,
                           .y = {.label = "phase", .unit = "°", .lower = -180.0, .upper = 180.0},
                           .lines = {line({}, later, 1, 0.6), line({}, earlier, 1, 0.6), line({}, phase, 0, 1.4)},
                           .rules = {}});
  if (with_coherence) {
    figure.panels.push_back({.title = {},
                             .x = frequency,
                             .y = {.label = "coherence", .lower = 0.0, .upper = 1.0},
                             .lines = {line({}, coherence, 0, 1.4)},
                             .rules = {}});
  }
  return figure;
}

std::string csv_of(const std::vector<Row>& rows) {
  std::string text = "frequency_Hz,gain,gain_95,phase_deg,phase_95_deg,coherence\n";
  for (const Row& row : rows) {
    for (const double value : {row.frequency_Hz, row.gain, row.gain_95, row.phase_deg, row.phase_95_deg}) {
      text += format_number(value) + ",";
    }
    text += format_number(row.coherence) + "\n";
  }
  return text;
}

std::string json_of(const Estimates& found, const std::vector<Row>& rows, const std::string& unit) {
  using Json = nlohmann::ordered_json;
  Json lines = Json::array();
  for (const Row& row : rows) {
    lines.push_back({{"frequency_Hz", row.frequency_Hz},
                     {"gain", row.gain},
                     {"gain_95", row.gain_95},
                     {"phase_deg", row.phase_deg},
                     {"phase_95_deg", row.phase_95_deg},
                     {"coherence", row.coherence}});
  }
  Json json{{"estimate", found.how}, {"sample_time_s", found.sample_time.value}, {"unit", unit}, {"response", lines}};
  if (found.linearity) {
    json["linearity"] = {{"linear", found.linearity->linear},
                         {"outside", found.linearity->outside},
                         {"spread", found.linearity->spread},
                         {"worst_Hz", found.linearity->worst_Hz}};
  }
  return report::json_text(json);
}

Check identify(const FrfOptions& options, const std::string& command) {
  auto output = OutputFolder::open(options.results);
  if (!output) return output.error();
  const auto runs = read_runs(options);
  if (!runs) return runs.error();
  const auto found = estimate_all(options, *runs);
  if (!found) return found.error();
  const std::vector<Row> rows = rows_of(options, found->response);
  if (rows.empty()) return inconsistent("no line of the response lies between the frequencies given", "--lower-Hz");

  const std::string& above = runs->front().output.unit;
  const std::string& below = runs->front().input.unit;
  const std::string unit = above.empty() || below.empty() ? "" : above + "/" + below;
  const report::Table table = table_of(rows, unit);
  const std::string json = json_of(*found, rows, unit);
  const std::string text = (found->linearity ? verdict(*found->linearity) + "\n" : std::string()) + found->how + ", " +
                           std::to_string(runs->size()) + (runs->size() == 1 ? " recording\n" : " recordings\n") +
                           table.to_text();
  const report::Figure figure = figure_of(rows, unit, !found->response.coherence.empty());
  report::Page page("Frequency response from " + options.input + " to " + options.output);
  if (found->linearity) page.paragraph(verdict(*found->linearity));
  page.paragraph(found->how + ".");
  page.figure(figure);
  page.table(table);
  page.footer("tactus " + std::string(version()), command);
  return write_outcome(*output, {.text = text, .json = json, .html = page.to_html(), .figures = {figure}},
                       {{"response.csv", csv_of(rows)}});
}

}  // namespace

void add_identify_frf(CLI::App& identify_command, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<FrfOptions>();
  CLI::App* verb =
      identify_command.add_subcommand("frf", "Estimate a frequency response with 95 % bands from recordings");
  verb->add_option("RECORDING", options->files, "Recordings, averaged: .csv, .tsv, .txt or .mat (version 5)")
      ->required();
  verb->add_option("--input", options->input, "Input column; in a MATLAB file NAME:COLUMN")
      ->required()
      ->type_name("NAME");
  verb->add_option("--output", options->output, "Output column")->required()->type_name("NAME");
  verb->add_option("--time", options->time, "Time column, or two as sec,nanosec")->type_name("NAME");
  verb->add_option("--time-unit", options->time_unit, "Unit of the times, if the file does not state it")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}));
  verb->add_option("--sample-time-s", options->sample_time_s, "Time between samples, if the file has no times")
      ->type_name("S");
  verb->add_option("--method", options->method, "Estimator: h1 (noise on the output), h2 (noise on the input) or etfe")
      ->check(CLI::IsMember({"h1", "h2", "etfe"}));
  verb->add_option("--segment-samples", options->segment_samples, "Samples per segment, a power of two")
      ->type_name("N");
  verb->add_option("--smoothing-lines", options->smoothing_lines,
                   "Frequency lines that the ETFE averages, an odd number")
      ->type_name("N");
  verb->add_option("--lower-Hz", options->lower_Hz, "Lowest frequency to report")->type_name("HZ");
  verb->add_option("--upper-Hz", options->upper_Hz, "Highest frequency to report")->type_name("HZ");
  verb->add_flag("--compare", options->compare, "Report whether one linear device explains all recordings");
  options->results.own_files = {"response.csv"};
  add_output_options(*verb, options->results, command,
                     "Folder for report.html, results.json, response.csv and the figure");
  verb->callback([options, name, &command, &status] {
    if (const auto error = identify(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
