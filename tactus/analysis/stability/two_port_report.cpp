// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/two_port_report.hpp>
#include <tactus/analysis/stability/two_port_sweep.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace tactus::stability {

namespace {

/// The point with the least of `value`.
template <class Value>
const TwoPortPoint& least(const TwoPortSweep& sweep, const Value& value) {
  return *std::min_element(sweep.points.begin(), sweep.points.end(),
                           [&value](const auto& a, const auto& b) { return value(a) < value(b); });
}

double llewellyn_of(const TwoPortPoint& point) { return point.llewellyn; }
double passivity_of(const TwoPortPoint& point) { return point.passivity; }
double minus_scattering_of(const TwoPortPoint& point) { return -point.scattering; }

report::Table summary_table(const TwoPortSweep& sweep) {
  report::Table table(
      {{"what", "", report::Column::Align::left}, {"value"}, {"unit", "", report::Column::Align::left}, {"at", "Hz"}},
      "Two-port between hand and tip");
  const auto row = [&table](const char* what, double value, const char* unit, double at_Hz) {
    table.add_row({what, report::number(value, 4), unit, report::number(at_Hz, 4)});
  };
  const TwoPortPoint& stable = least(sweep, llewellyn_of);
  row("least Llewellyn index; stable between any passive ends from 1", stable.llewellyn, "", stable.frequency_Hz);
  const TwoPortPoint& scattered = least(sweep, minus_scattering_of);
  row("largest scattering norm; passive up to 1", scattered.scattering, "", scattered.frequency_Hz);
  const TwoPortPoint& passive = least(sweep, passivity_of);
  row("least passivity index; passive from 0", passive.passivity, "", passive.frequency_Hz);
  const auto width = [](const TwoPortPoint& point) {
    return std::abs(point.contact_N_s_per_m) / std::abs(point.free_N_s_per_m);
  };
  const TwoPortPoint& narrow = least(sweep, [&width](const auto& point) {
    return point.frequency_Hz <= 100.0 ? width(point) : std::numeric_limits<double>::infinity();
  });
  row("least wall felt over free motion felt, to 100 Hz", width(narrow), "", narrow.frequency_Hz);
  const auto to_Hz = sweep.transparent_to_Hz();
  table.add_row({"the wall is felt within 3 dB up to", to_Hz ? report::number(*to_Hz, 4) : "none", "Hz", ""});
  return table;
}

std::string verdict_of(const TwoPortSweep& sweep) {
  const TwoPortPoint &stable = least(sweep, llewellyn_of), &passive = least(sweep, passivity_of);
  const bool is_stable = stable.llewellyn >= 1.0, is_passive = passive.passivity >= 0.0;
  std::string text = is_passive  ? "Passive: stable between any passive hand and wall"
                     : is_stable ? "Stable between any passive hand and wall, though not passive"
                                 : "Not stable between any passive hand and wall";
  if (!is_stable)
    text += ": least Llewellyn index " + report::number(stable.llewellyn, 3) + " at " +
            report::number(stable.frequency_Hz, 3) + " Hz, where 1 is needed";
  const auto to_Hz = sweep.transparent_to_Hz();
  return text + "; the wall is felt within 3 dB " +
         (to_Hz ? "up to " + report::number(*to_Hz, 3) + " Hz." : std::string("nowhere."));
}

report::Table frequency_table(const TwoPortSweep& sweep) {
  report::Table table({{"frequency", "Hz"},
                       {"|h11|", "N s/m"},
                       {"|h12|"},
                       {"|h21|"},
                       {"|h22|", "m/(N s)"},
                       {"Llewellyn"},
                       {"scattering"},
                       {"passivity"},
                       {"free", "N s/m"},
                       {"on the wall", "N s/m"},
                       {"transparency", "dB"},
                       {"its phase", "degrees"}},
                      "Over frequency");
  for (const double wanted_Hz : {1.0, 3.0, 10.0, 30.0, 75.0, 100.0, 300.0, 1000.0}) {
    const TwoPortPoint& point =
        least(sweep, [wanted_Hz](const TwoPortPoint& at) { return std::fabs(std::log(at.frequency_Hz / wanted_Hz)); });
    if (std::fabs(point.frequency_Hz / wanted_Hz - 1.0) > 0.05) continue;
    const auto number = [](double value) { return report::number(value, 3); };
    const HybridMatrix& h = point.hybrid;
    table.add_row({number(point.frequency_Hz), number(std::abs(h.h11)), number(std::abs(h.h12)),
                   number(std::abs(h.h21)), number(std::abs(h.h22)), number(point.llewellyn), number(point.scattering),
                   number(point.passivity), number(std::abs(point.free_N_s_per_m)),
                   number(std::abs(point.contact_N_s_per_m)), number(20.0 * std::log10(std::abs(point.transparency))),
                   number(degree * std::arg(point.transparency))});
  }
  return table;
}

report::Figure hybrid_figure(const TwoPortSweep& sweep) {
  const auto hertz = sweep.over([](const TwoPortPoint& point) { return point.frequency_Hz; });
  report::Figure figure{
      .title = "Hybrid matrix",
      .caption = "[F_h; -v_s] = H [v_m; F_s]. Ideal are h11 = h22 = 0, |h12| = mu and |h21| = lambda.",
      .columns = 2,
      .panels = {}};
  const auto panel = [&](const char* title, const char* label, const char* unit, auto entry, int colour) {
    figure.panels.push_back(
        {title,
         two_port_axis(),
         {.label = label, .unit = unit, .scale = report::Axis::Scale::logarithmic},
         {{"", hertz, sweep.over([&entry](const TwoPortPoint& point) { return std::abs(entry(point.hybrid)); }),
           colour}},
         {}});
  };
  panel(
      "h11: what free motion costs", "|h11|", "N s/m", [](const auto& h) { return h.h11; }, 0);
  panel(
      "h12: force that comes back", "|h12|", "", [](const auto& h) { return h.h12; }, 1);
  panel(
      "h21: motion that goes out", "|h21|", "", [](const auto& h) { return h.h21; }, 2);
  panel(
      "h22: how the tip gives way", "|h22|", "m/(N s)", [](const auto& h) { return h.h22; }, 3);
  return figure;
}

std::string json_of(const experiments::Request& request, const TwoPortSweep& sweep) {
  using Json = nlohmann::ordered_json;
  const auto to_Hz = sweep.transparent_to_Hz();
  Json document{{"experiment", request.name},
                {"least_llewellyn_index", least(sweep, llewellyn_of).llewellyn},
                {"largest_scattering_norm", least(sweep, minus_scattering_of).scattering},
                {"least_passivity_index", least(sweep, passivity_of).passivity},
                {"transparent_to_Hz", to_Hz ? Json(*to_Hz) : Json(nullptr)},
                {"reference_N_s_per_m", sweep.reference_N_s_per_m},
                {"frequency_Hz", sweep.over([](const TwoPortPoint& point) { return point.frequency_Hz; })}};
  const auto complex = [&](const char* key, auto value) {
    document[key] = {{"re", sweep.over([&value](const TwoPortPoint& point) { return value(point).real(); })},
                     {"im", sweep.over([&value](const TwoPortPoint& point) { return value(point).imag(); })}};
  };
  complex("h11_N_s_per_m", [](const TwoPortPoint& point) { return point.hybrid.h11; });
  complex("h12", [](const TwoPortPoint& point) { return point.hybrid.h12; });
  complex("h21", [](const TwoPortPoint& point) { return point.hybrid.h21; });
  complex("h22_m_per_N_s", [](const TwoPortPoint& point) { return point.hybrid.h22; });
  document["llewellyn_index"] = sweep.over(llewellyn_of);
  document["scattering_norm"] = sweep.over([](const TwoPortPoint& point) { return point.scattering; });
  document["passivity_index"] = sweep.over(passivity_of);
  complex("free_N_s_per_m", [](const TwoPortPoint& point) { return point.free_N_s_per_m; });
  complex("on_the_wall_N_s_per_m", [](const TwoPortPoint& point) { return point.contact_N_s_per_m; });
  complex("transparency", [](const TwoPortPoint& point) { return point.transparency; });
  return report::json_text(document);
}

}  // namespace

Result<experiments::Outcome> report_two_port(const experiments::Request& request, const ReportOptions& options) {
  const auto params = request.document.read<experiments::TappingParams>();
  if (!params) return params.error();
  const auto sweep = sweep_two_port(*params, options.linearisation);
  if (!sweep) return request.document.locate(sweep.error());
  const report::Table summary = summary_table(*sweep), table = frequency_table(*sweep);
  std::vector<report::Figure> figures{two_port_figure(*sweep), hybrid_figure(*sweep)};
  const std::string verdict = verdict_of(*sweep);
  report::Page page(request.name + ": two-port");
  page.paragraph(verdict);
  page.paragraph(
      "The teleoperator as a two-port between the hand on the handle and whatever the tip touches: linear, sampled, "
      "exact "
      "for a sinusoid up to the images of the holds. Waves have the impedance of the hand's damper.");
  page.table(summary);
  page.table(table);
  for (const report::Figure& figure : figures) page.figure(figure);
  return experiments::outcome_of({.text = verdict + "\n\n" + summary.to_text() + table.to_text(),
                                  .json = json_of(request, *sweep),
                                  .page = std::move(page),
                                  .figures = std::move(figures)},
                                 request, configuration::to_toml(*params));
}

}  // namespace tactus::stability
