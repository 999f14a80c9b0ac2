#include <tactus/cli/progress_line.hpp>
#include <tactus/cli/stability.hpp>
#include <tactus/cli/standard_output.hpp>
#include <tactus/configuration/document.hpp>
#include <tactus/report/files.hpp>
#include <tactus/report/heat_map.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>
#include <tactus/stability/map.hpp>
#include <tactus/stability/map_hdf5.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

struct MapOptions {
  std::string file;
  std::vector<std::string> set;
  std::vector<std::string> vary;
  std::string precision = "double";
  std::optional<std::string> out;
  bool json = false;
};

/// Which process of how many this is, as the launcher of Open MPI tells every program that it starts.
stability::MapShare share_of_this_process() {
  const auto number = [](const char* name, long otherwise) {
    const char* text = std::getenv(name);
    const long value = text != nullptr ? std::strtol(text, nullptr, 10) : otherwise;
    return value;
  };
  const long ranks = number("OMPI_COMM_WORLD_SIZE", 1), rank = number("OMPI_COMM_WORLD_RANK", 0);
  if (ranks < 1 || rank < 0 || rank >= ranks) return {};
  return {.rank = static_cast<std::size_t>(rank), .ranks = static_cast<std::size_t>(ranks)};
}

Result<stability::MapRequest> make_request(const MapOptions& options, const configuration::Document& document) {
  auto base = document.read<stability::MapParams>();
  if (!base) return base.error();
  stability::MapRequest request;
  request.base = *std::move(base);
  for (const std::string& text : options.vary) {
    auto axis = stability::parse_axis(text);
    if (!axis) return axis.error();
    request.axes.push_back(*std::move(axis));
  }
  request.precision =
      options.precision == "float" ? stability::MapPrecision::lanes_of_float : stability::MapPrecision::lanes_of_double;
  request.share = share_of_this_process();
  if (options.out) request.folder = *options.out;
  if ((options.out && options.out->empty()) || (request.share.ranks > 1 && !options.out)) {
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message =
                     "no folder is named, and several processes need one that they share: write one, as in "
                     "--out results",
                 .place = "--out"};
  }
  return request;
}

constexpr std::size_t verdicts = 4;

std::array<std::size_t, verdicts> count(const stability::MapResult& map, std::size_t first, std::size_t points) {
  std::array<std::size_t, verdicts> counts{};
  for (std::size_t i = 0; i < points; ++i) ++counts[static_cast<std::size_t>(map.points[first + i].verdict)];
  return counts;
}

/// One plane of the last two axes: what it is called, and where it begins.
struct Plane {
  std::string title;
  std::size_t first;
};

std::vector<Plane> planes_of(const stability::MapResult& map, std::size_t size) {
  std::vector<Plane> planes;
  for (std::size_t first = 0; first < map.points.size(); first += size) {
    std::string title;
    std::size_t stride = map.points.size();
    for (std::size_t axis = 0; axis + 2 < map.axes.size(); ++axis) {
      const auto& of = map.axes[axis];
      stride /= of.values.size();
      const std::size_t at = first / stride % of.values.size();
      title += (title.empty() ? "" : ", ") + of.key + " = " +
               (of.words.empty() ? report::number(of.values[at], 3) + " " + of.unit : of.words[at]);
    }
    planes.push_back({title.empty() ? "all" : title, first});
  }
  return planes;
}

report::HeatMap draw(const stability::MapResult& map, const std::vector<Plane>& planes) {
  const auto& y = map.axes[map.axes.size() - 2];
  const auto& x = map.axes.back();
  report::HeatMap picture{
      .title = "Stability map",
      .x = {x.key, x.unit, x.values, x.logarithmic},
      .y = {y.key, y.unit, y.values, y.logarithmic},
      .classes = {{"settled", "#cfe8d5"}, {"ringing", "#ffe08a"}, {"limit-cycle", "#f2a07b"}, {"diverged", "#8a4b7d"}},
      .panels = {},
      .lines = {}};
  const std::size_t size = x.values.size() * y.values.size();
  const auto limits = stability::settled_limit(map, map.axes.size() - 2);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    report::HeatMap::Panel panel{planes[i].title, {}};
    for (std::size_t n = 0; n < size; ++n) {
      panel.cells.push_back(static_cast<std::size_t>(map.points[planes[i].first + n].verdict));
    }
    picture.panels.push_back(std::move(panel));
    const auto from = limits.begin() + static_cast<std::ptrdiff_t>(i * x.values.size());
    // Two boundaries can be told apart in one picture; more stand each in its own panel.
    const bool compared = planes.size() <= 2;
    picture.lines.push_back({.name = "limit, " + planes[i].title,
                             .y = std::vector<double>(from, from + static_cast<std::ptrdiff_t>(x.values.size())),
                             .dashed = compared && i > 0,
                             .panel = compared ? std::nullopt : std::optional(i)});
  }
  return picture;
}

Check present(const MapOptions& options, const stability::MapResult& map, double seconds, const std::string& command) {
  const bool plane = map.axes.size() >= 2 && map.axes.back().words.empty() && map.axes.back().values.size() > 1 &&
                     map.axes[map.axes.size() - 2].words.empty() && map.axes[map.axes.size() - 2].values.size() > 1;
  const std::size_t size =
      plane ? map.axes.back().values.size() * map.axes[map.axes.size() - 2].values.size() : map.points.size();
  const auto planes = planes_of(map, size);
  const auto limits =
      plane ? stability::settled_limit(map, map.axes.size() - 2) : stability::settled_limit(map, map.axes.size() - 1);

  nlohmann::ordered_json json;
  json["command"] = command;
  json["points"] = map.points.size();
  json["resumed_points"] = map.resumed;
  json["redone_in_double"] = map.redone;
  json["instruction_set"] = map.instruction_set;
  json["loop_ticks"] = map.ticks;
  json["elapsed_s"] = seconds;
  std::string text = std::to_string(map.points.size()) + " points in " + report::number(seconds, 3) + " s, " +
                     report::number(map.ticks / seconds / 1e6, 3) + " million loop ticks a second (" +
                     map.instruction_set + "); " + std::to_string(map.resumed) + " from an earlier run, " +
                     std::to_string(map.redone) + " again in double\n";
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const auto counts = count(map, planes[i].first, size);
    text += planes[i].title + ":";
    nlohmann::ordered_json entry;
    entry["plane"] = planes[i].title;
    for (std::size_t verdict = 0; verdict < verdicts; ++verdict) {
      const std::string name(name_of(static_cast<simulation::Verdict>(verdict)));
      entry[name] = counts[verdict];
      text += "  " + name + " " +
              report::number(100.0 * static_cast<double>(counts[verdict]) / static_cast<double>(size), 3) + " %";
    }
    text += "\n";
    json["planes"].push_back(std::move(entry));
  }
  json["axes"] = nlohmann::ordered_json::array();
  for (const auto& axis : map.axes) {
    nlohmann::ordered_json entry{{"key", axis.key}, {"unit", axis.unit}, {"values", axis.values}};
    if (!axis.words.empty()) entry["values"] = axis.words;
    json["axes"].push_back(std::move(entry));
  }
  // JSON has no NaN: where not even the first value settled stands null.
  json["settled_limit"] = limits;
  const std::string document = json.dump(2) + "\n";
  std::cout << (options.json ? document : text);
  if (auto error = flush_standard_output()) return error;
  if (!options.out) return {};
  const std::filesystem::path folder = *options.out;
  if (auto error = report::write_file(folder / "results.json", document)) return error;
  if (auto error = report::write_file(folder / "map.csv", stability::to_csv(map))) return error;
  if (auto error = stability::write_hdf5(folder / "map.h5", map)) return error;
  if (!plane) return {};
  if (auto error = report::write_file(folder / "map.svg", report::to_svg(draw(map, planes)))) return error;
  (options.json ? std::cerr : std::cout) << "Map: " << (folder / "map.svg").string() << "\n";
  return {};
}

Check run(const MapOptions& options, const std::string& command) {
  auto document = configuration::Document::load(options.file);
  if (!document) return document.error();
  for (const std::string& assignment : options.set) {
    if (auto error = document->set(assignment)) return error;
  }
  const auto request = make_request(options, *document);
  if (!request) return request.error();
  const auto start = std::chrono::steady_clock::now();
  const auto map = [&] {
    ProgressLine line("map");
    return stability::run_map(*request, [&line](double done) { line.update(done); });
  }();
  if (!map) return document->locate(map.error());
  if (request->share.rank > 0) return {};
  return present(options, *map, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                 command);
}

}  // namespace

void add_stability_map(CLI::App& stability, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<MapOptions>();
  CLI::App* verb = stability.add_subcommand("map", "Run a tap at every point of a grid and draw where it is stable");
  verb->add_option("EXPERIMENT", options->file, "File of kind stability-map (TOML)")->required();
  verb->add_option("--set", options->set, "Override one value: key=value")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  verb->add_option("--vary", options->vary, "An axis: key=from:to:count, key=from:to:count[log] or key=a,b,c")
      ->type_name("AXIS")
      ->required()
      ->allow_extra_args(false);
  verb->add_option("--precision", options->precision, "double, or float with the boundary again in double")
      ->check(CLI::IsMember({"double", "float"}));
  verb->add_option("--out", options->out,
                   "Folder for map.csv, map.h5, map.svg and results.json; a killed run goes on from there")
      ->type_name("DIR");
  verb->add_flag("--json", options->json, "Print one JSON document and nothing else");
  verb->callback([options, name, &command, &status] {
    if (const auto error = run(*options, command)) {
      std::cerr << name << ": " << describe(*error) << "\n";
      status = exit_status(*error);
    }
  });
}

}  // namespace tactus::cli
