// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/contest/presentation.hpp>
#include <tactus/simulation/experiments/internal/gain_json.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t shown_gain = 1;  // of `contest_gains`: where plain position-force has failed and others have not

std::string text_of(const GainLimit& limit, const ContestParams& params) {
  return gain_limit_text(limit, params.task.lowest_gain);
}

bool settles(const GainScore& score) { return score.metrics.verdict == Verdict::settled; }

std::string in_newton(double force_N) { return format_number(force_N) + " N"; }

Json json_of_score(const GainScore& score) {
  Json json{{"force_gain", score.force_gain}, {"force_limit_N", score.force_limit_N}};
  json.update(json_of_settling(score.metrics));
  json["verdict"] = name_of(score.metrics.verdict);
  json["spectral_error"] = json_of(score.spectral_error);
  return json;
}

template <std::size_t n>
Json json_of_conditions(const char* condition, const std::array<double, n>& values,
                        const std::array<GainLimit, n>& limits) {
  Json list = Json::array();
  for (std::size_t i = 0; i < n; ++i) {
    Json entry{{condition, values[i]}};
    entry.update(json_of(limits[i]));
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace

std::string contest_verdict(const std::vector<MethodScore>& scores, const ContestParams& params) {
  const auto best = std::max_element(scores.begin(), scores.end(), [](const MethodScore& a, const MethodScore& b) {
    return a.limit.gain < b.limit.gain;
  });
  const std::string method(contest_methods()[static_cast<std::size_t>(best - scores.begin())].name);
  return "The largest force gain that settles is " + text_of(best->limit, params) + ", with " + method + ".";
}

report::Table contest_table(const std::vector<MethodScore>& scores, const ContestParams& params) {
  using Align = report::Column::Align;
  std::vector<report::Column> columns{
      {"method", "", Align::left}, {"gain limit"}, {"at " + in_newton(params.task.strong_display_N)}};
  for (const double delay_s : contest_delays_s) columns.push_back({"at " + format_number(1e3 * delay_s) + " ms"});
  for (const double grip : contest_grips) columns.push_back({"grip × " + format_number(grip)});
  const std::string at_gain = "at " + format_number(contest_gains[shown_gain]);
  columns.insert(columns.end(),
                 {{"settling " + at_gain, "ms"}, {"hand error " + at_gain, "%"}, {"effort", "mN RMS"}, {"lag", "ms"}});
  report::Table table(columns, "The largest force gain that settles, and what the method costs");
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const MethodScore& score = scores[i];
    std::vector<std::string> cells{std::string(contest_methods()[i].name), text_of(score.limit, params),
                                   text_of(score.strong_display, params)};
    for (const GainLimit& limit : score.delayed) cells.push_back(text_of(limit, params));
    for (const GainLimit& limit : score.gripped) cells.push_back(text_of(limit, params));
    const GainScore& shown = score.at_gain[shown_gain];
    cells.push_back(settles(shown) ? report::number(1e3 * shown.metrics.settling_time_median_s, 3) : "–");
    cells.push_back(settles(shown) ? percent(shown.spectral_error) : "–");
    cells.push_back(report::number(1e3 * score.free_space.hand_force_rms_N, 3));
    cells.push_back(score.free_space.lag_s ? report::number(1e3 * *score.free_space.lag_s, 3) : "–");
    table.add_row(cells);
  }
  return table;
}

report::Figure contest_figure(const std::vector<MethodScore>& scores, const ContestParams& params) {
  std::vector<std::string> names;
  report::Bars limit{.name = "display up to " + in_newton(params.control.force_limit_N), .lengths = {}};
  report::Bars strong{.name = "display up to " + in_newton(params.task.strong_display_N), .lengths = {}, .colour = 1};
  report::Bars error{.name = "", .lengths = {}, .colour = 2};
  report::Bars effort = error;
  report::Bars lag = error;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const MethodScore& score = scores[i];
    names.emplace_back(contest_methods()[i].name);
    const auto add = [](report::Bars& bars, const std::optional<double>& length, const std::string& label) {
      bars.lengths.push_back(length.value_or(std::numeric_limits<double>::quiet_NaN()));
      bars.labels.push_back(label);
    };
    const auto scaled = [](const std::optional<double>& value, double factor) {
      return value ? std::optional(factor * *value) : std::nullopt;
    };
    add(limit, score.limit.gain, text_of(score.limit, params));
    add(strong, score.strong_display.gain, text_of(score.strong_display, params));
    const GainScore& shown = score.at_gain[shown_gain];
    const std::optional<double> heard = settles(shown) ? shown.spectral_error : std::nullopt;
    add(error, scaled(heard, 100.0), heard ? percent(heard) : "does not settle");
    const double force_mN = 1e3 * score.free_space.hand_force_rms_N;
    add(effort, force_mN, report::number(force_mN, 2));
    const std::optional<double> lag_ms = scaled(score.free_space.lag_s, 1e3);
    add(lag, lag_ms, lag_ms ? report::number(*lag_ms, 2) : "never there");
  }
  const report::Axis methods{.label = "", .categories = names};
  const auto panel = [&methods](std::string title, report::Axis x, std::vector<report::Bars> bars) {
    return report::Panel{
        .title = std::move(title), .x = std::move(x), .y = methods, .lines = {}, .rules = {}, .bars = std::move(bars)};
  };
  // Room for the labels behind the bars.
  const auto room_for = [](const report::Bars& bars) {
    double longest = 0.0;
    for (const double length : bars.lengths) longest = std::fmax(longest, length);
    return 1.3 * longest;
  };
  report::Figure figure{.title = "How much force gain each method allows, and what it costs",
                        .caption = "A good method has long bars on the left and short ones next to them.",
                        .columns = 4,
                        .panels = {},
                        .share_y = report::Sharing::in_line};
  figure.panels.push_back(panel("largest gain that settles",
                                {.label = "force gain",
                                 .lower = params.task.lowest_gain,
                                 .upper = 4.0 * params.task.highest_gain,
                                 .scale = report::Axis::Scale::logarithmic},
                                {limit, strong}));
  figure.panels.push_back(panel("error at the hand, gain " + format_number(contest_gains[shown_gain]),
                                {.label = "spectral error", .unit = "%", .upper = room_for(error)}, {error}));
  figure.panels.push_back(
      panel("effort in free space", {.label = "force", .unit = "mN RMS", .upper = room_for(effort)}, {effort}));
  figure.panels.push_back(panel("lag in free space", {.label = "lag", .unit = "ms", .upper = room_for(lag)}, {lag}));
  return figure;
}

std::string contest_json(const std::string& experiment, const std::vector<MethodScore>& scores,
                         const ContestParams& params) {
  Json document{{"experiment", experiment},
                {"lowest_gain", params.task.lowest_gain},
                {"highest_gain", params.task.highest_gain},
                {"methods", Json::array()}};
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const MethodScore& score = scores[i];
    const ContestMethod& method = contest_methods()[i];
    Json at_gain = Json::array();
    for (const GainScore& one : score.at_gain) at_gain.push_back(json_of_score(one));
    for (const GainScore& one : score.strong_at_gain) at_gain.push_back(json_of_score(one));
    Json strong{{"force_limit_N", params.task.strong_display_N}};
    strong.update(json_of(score.strong_display));
    Json entry{{"name", method.name}, {"set", method.settings}};
    entry.update(json_of(score.limit));
    entry["metrics"] = {{"strong_display", strong},
                        {"delays", json_of_conditions("delay_s", contest_delays_s, score.delayed)},
                        {"grips", json_of_conditions("grip", contest_grips, score.gripped)},
                        {"gains", at_gain},
                        {"free_space_hand_force_rms_N", score.free_space.hand_force_rms_N},
                        {"free_space_lag_s", json_of(score.free_space.lag_s)}};
    document["methods"].push_back(std::move(entry));
  }
  return report::json_text(document);
}

}  // namespace tactus::experiments
