// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/limit_ladder.hpp>
#include <tactus/analysis/stability/limit_report.hpp>
#include <tactus/analysis/stability/margins.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace tactus::stability {

namespace {

std::string shown(const experiments::GainLimit& limit) {
  return experiments::gain_limit_text(limit, lowest_tried_gain);
}

std::string ratio(const experiments::GainLimit& limit, const experiments::GainLimit& over) {
  if (limit.gain == 0.0 || over.gain == 0.0 || (limit.beyond_search && over.beyond_search)) return "";
  const char* bound = limit.beyond_search ? "≥ " : over.beyond_search ? "≤ " : "";
  return bound + report::number(limit.gain / over.gain, 3);
}

report::Table ladder_table(const std::vector<LimitRung>& rungs) {
  report::Table table({{"gain limit of", "", report::Column::Align::left},
                       {"force gain"},
                       {"over the row above"},
                       {"effect added", "", report::Column::Align::left}},
                      "Gain limit, from the linear loop to the taps of the file");
  for (std::size_t i = 0; i < rungs.size(); ++i) {
    table.add_row(
        {rungs[i].words, shown(rungs[i].limit), i > 0 ? ratio(rungs[i].limit, rungs[i - 1].limit) : "", rungs[i].adds});
  }
  return table;
}

report::Table without_table(const std::vector<LimitRung>& rungs) {
  report::Table table({{"taps of the file without", "", report::Column::Align::left}, {"force gain"}, {"over row 1"}},
                      "One effect removed at a time");
  table.add_row({"nothing", shown(rungs.back().limit), ""});
  for (const LimitRung& rung : rungs) {
    if (rung.without) table.add_row({rung.adds, shown(*rung.without), ratio(*rung.without, rungs.back().limit)});
  }
  return table;
}

report::Figure ladder_figure(const std::vector<LimitRung>& rungs) {
  report::Panel panel{"",
                      {.label = "force gain", .lower = lowest_tried_gain, .scale = report::Axis::Scale::logarithmic},
                      {.label = ""},
                      {},
                      {}};
  report::Bars limits{.name = "up to here", .lengths = {}};
  report::Bars without{.name = "the file without it", .lengths = {}, .colour = 1};
  for (const LimitRung& rung : rungs) {
    panel.y.categories.push_back(rung.words);
    limits.lengths.push_back(rung.limit.gain);
    limits.labels.push_back(shown(rung.limit));
    without.lengths.push_back(rung.without ? rung.without->gain : std::nan(""));
    without.labels.push_back(rung.without ? shown(*rung.without) : "");
  }
  panel.bars = {limits, without};
  return {.title = "Gain limit",
          .caption =
              "Each row has all that the rows above it have, and one thing more; the second bar is the file's own with "
              "that one thing taken out. A ≥ marks the end of the search.",
          .columns = 1,
          .panels = {panel}};
}

/// The gain limit of the linear loop with friction as a damper, over the velocity amplitude that it stands for.
struct FrictionCurve {
  std::vector<double> speed_m_per_s, limit;
};

Result<FrictionCurve> friction_curve(const experiments::TappingParams& params, Linearisation linearisation) {
  FrictionCurve curve;
  for (double speed = 1e-3; speed < 1.0; speed *= 1.25) {
    linearisation.friction_speed_m_per_s = speed;
    const auto loop = make_loop(params, linearisation);
    if (!loop) return loop.error();
    curve.speed_m_per_s.push_back(speed);
    curve.limit.push_back(gain_limit(*loop).force_gain);
  }
  return curve;
}

report::Figure friction_figure(const FrictionCurve& curve, double frictionless, const experiments::GainLimit& taps) {
  const auto logarithmic = report::Axis::Scale::logarithmic;
  report::Figure figure{
      .title = "Friction as a describing function",
      .caption =
          "The linear gain limit with friction as a damper 4 f / (pi V), over the velocity amplitude V "
          "of the ringing. Left of the curve a ringing dies, right of it it grows: at a gain above the "
          "limit without friction, what friction holds is small motion only.",
      .columns = 1,
      .panels = {}};
  figure.panels.push_back({"",
                           {.label = "velocity amplitude", .unit = "m/s", .scale = logarithmic},
                           {.label = "force gain", .scale = logarithmic},
                           {{"linear limit with friction", curve.speed_m_per_s, curve.limit}},
                           {}});
  const auto rule = [&figure](double at, const char* label) {
    if (at > 0.0 && std::isfinite(at)) figure.panels[0].rules.push_back({.at = at, .label = label});
  };
  rule(frictionless, "without friction");
  if (!taps.beyond_search) rule(taps.gain, "taps of the file");
  return figure;
}

/// The rung that moves the limit most; none where nothing does.
const LimitRung* farthest(const std::vector<LimitRung>& rungs) {
  const LimitRung* found = nullptr;
  double most = std::log(1.05);
  for (std::size_t i = 1; i < rungs.size(); ++i) {
    const double before = rungs[i - 1].limit.gain, after = rungs[i].limit.gain;
    const double gap = before > 0.0 && after > 0.0 ? std::fabs(std::log(after / before)) : before == after ? 0.0 : 1e9;
    if (gap > most) {
      most = gap;
      found = &rungs[i];
    }
  }
  return found;
}

nlohmann::ordered_json json_of(const experiments::GainLimit& limit) {
  nlohmann::ordered_json object{{"force_gain", limit.gain}};
  if (limit.censored()) object["force_gain_censored"] = true;
  return object;
}

}  // namespace

Result<experiments::Outcome> report_limit(const experiments::Request& request, const ReportOptions& options,
                                          const experiments::Progress& progress) {
  const auto params = request.document.read<experiments::TappingParams>();
  if (!params) return params.error();
  const auto loop = make_loop(*params, options.linearisation);
  if (!loop) return request.document.locate(loop.error());
  const auto rungs = limit_ladder(*params, options.linearisation, progress);
  if (!rungs) return request.document.locate(rungs.error());
  const auto curve = friction_curve(*params, options.linearisation);
  if (!curve) return request.document.locate(curve.error());

  const GainLimit linear = gain_limit(*loop);
  nlohmann::ordered_json document{{"experiment", request.name},
                                  {"linear_frequency_Hz", linear.frequency_rad_per_s / turn},
                                  {"limits", nlohmann::ordered_json::array()}};
  for (const LimitRung& rung : *rungs) {
    nlohmann::ordered_json entry{{"of", rung.key}};
    entry.update(json_of(rung.limit));
    if (rung.without) entry["file_without"] = json_of(*rung.without);
    document["limits"].push_back(std::move(entry));
  }
  const LimitRung* cause = farthest(*rungs);
  document["largest_gap"] = cause != nullptr ? nlohmann::ordered_json(cause->key) : nlohmann::ordered_json(nullptr);
  document["friction"] = {{"speed_m_per_s", curve->speed_m_per_s}, {"gain_limit", curve->limit}};

  const report::Table table = ladder_table(*rungs), taken_out = without_table(*rungs);
  const std::string verdict = "The taps of the file settle up to a force gain of " + shown(rungs->back().limit) + ".\n";
  const std::string reason = cause != nullptr ? "Largest change in the first table: " + cause->adds +
                                                    ". A change depends on the order; the second table does not.\n"
                                              : "No effect changes the limit by more than 5 %.\n";
  std::vector<report::Figure> figures{ladder_figure(*rungs),
                                      friction_figure(*curve, linear.force_gain, rungs->back().limit)};
  report::Page page(request.name + ": gain limit");
  page.paragraph(verdict + reason);
  page.paragraph(
      "The largest force gain up to which the contact calms down, from the linear loop to the taps of the file. Each "
      "row adds one effect. Taps count as settled when 95 % of them settle and half of them within 100 ms and two "
      "round "
      "trips.");
  page.table(table);
  page.table(taken_out);
  for (const report::Figure& figure : figures) page.figure(figure);
  return experiments::outcome_of({.text = verdict + reason + "\n" + table.to_text() + taken_out.to_text(),
                                  .json = report::json_text(document),
                                  .page = std::move(page),
                                  .figures = std::move(figures)},
                                 request, configuration::to_toml(*params));
}

}  // namespace tactus::stability
