// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/scorecard.hpp>
#include <tactus/analysis/stability/scorecard_report.hpp>
#include <tactus/analysis/stability/two_port_sweep.hpp>
#include <tactus/analysis/stability/z_width.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace tactus::stability {

namespace {

std::string four_digits_or_none(double value) { return std::isfinite(value) ? report::number(value, 4) : "none"; }

/// The stiffest walls in N/m that the closed forms allow the master alone to display, in the hand of the file.
struct VirtualWalls {
  double passive_N_per_m, quantised_N_per_m, stable_N_per_m, rest_N_per_m, small_rest_N_per_m;
};

VirtualWalls virtual_walls(const simulation::Teleoperator::Params& params) {
  const auto& chain = params.master.mechanism;
  const SampledWall wall{.damping_N_s_per_m = params.person.grip.damping_N_s_per_m,
                         .friction_N = chain.motor.friction_N + chain.drum.friction_N,
                         .resolution_m = params.master.encoder.resolution_m,
                         .tick_s = 1.0 / params.servo.rate_Hz,
                         .delay_s = params.servo.computation_delay_s};
  return {.passive_N_per_m = passive_stiffness_N_per_m(wall.damping_N_s_per_m, 0.0, wall.tick_s),
          .quantised_N_per_m =
              quantised_stiffness_N_per_m(wall.damping_N_s_per_m, wall.tick_s, wall.friction_N, wall.resolution_m),
          .stable_N_per_m = stable_stiffness_N_per_m(wall.damping_N_s_per_m, 0.0, wall.tick_s, wall.delay_s),
          .rest_N_per_m = wall.stiffest_at_rest_N_per_m(),
          .small_rest_N_per_m = wall.stiffest_held_N_per_m()};
}

report::Table card_table(const Scorecard& card, const simulation::Teleoperator::Params& params) {
  report::Table table(
      {{"what", "", report::Column::Align::left}, {"value"}, {"unit", "", report::Column::Align::left}, {"at", "Hz"}},
      "Scorecard of the master");
  const auto row = [&table](const char* what, double value, const char* unit, double at_Hz = 0.0) {
    table.add_row({what, four_digits_or_none(value), unit, at_Hz > 0.0 ? report::number(at_Hz, 4) : ""});
  };
  row("largest stable force gain", card.limit.force_gain, "", card.limit.frequency_rad_per_s / turn);
  row("the same without cancellation", card.uncancelled.force_gain, "", card.uncancelled.frequency_rad_per_s / turn);
  row("Daniel and McAree: mass of master over slave", card.mass_ratio, "");
  row("force bandwidth to the hand", card.force_bandwidth_Hz.value_or(INFINITY), "Hz");
  row("largest hand force over motor force", card.force_peak, "", card.force_peak_Hz);
  row("effort in free motion", card.effort_2_Hz_N_s_per_m, "N s/m", 2.0);
  row("effort in free motion", card.effort_10_Hz_N_s_per_m, "N s/m", 10.0);
  const VirtualWalls walls = virtual_walls(params);
  row("virtual wall that damping of the hand makes passive (Colgate, Brown)", walls.passive_N_per_m, "N/m");
  row("virtual wall that friction lets the encoder hide (Abbott, Okamura)", walls.quantised_N_per_m, "N/m");
  row("virtual wall that is stable with the computation delay (Gil, Hulin)", walls.stable_N_per_m, "N/m");
  row("virtual wall that comes to rest, whatever the motion (after Diolaiti)", walls.rest_N_per_m, "N/m");
  row("virtual wall on which small motion comes to rest (after Diolaiti)", walls.small_rest_N_per_m, "N/m");
  return table;
}

report::Table sensitivity_table(const Scorecard& card) {
  constexpr std::size_t most = 15;
  report::Table table({{"10 % more of", "", report::Column::Align::left}, {"gain limit", "%"}},
                      "What changes the gain limit most");
  for (std::size_t i = 0; i < std::min(most, card.sensitivities.size()); ++i) {
    table.add_row({card.sensitivities[i].key, report::number(100.0 * card.sensitivities[i].limit_change, 3)});
  }
  return table;
}

std::string limited_by(const Scorecard& card) {
  if (!std::isfinite(card.limit.force_gain)) return "No force gain makes the linear loop unstable.\n";
  if (card.limit.force_gain == 0.0) return "One of the devices is unstable without any force between them.\n";
  std::string text = "Limited at " + report::number(card.limit.frequency_rad_per_s / turn, 4) + " Hz";
  const auto device = std::find_if(card.sensitivities.begin(), card.sensitivities.end(),
                                   [](const Sensitivity& s) { return s.key.starts_with("master.mechanism."); });
  if (device != card.sensitivities.end()) text += ", of the master mostly by " + device->key;
  return text + ".\n";
}

}  // namespace

Result<experiments::Outcome> report_scorecard(const experiments::Request& request, const ReportOptions& options,
                                              const experiments::Progress& progress) {
  const auto params = request.document.read<experiments::TappingParams>();
  if (!params) return params.error();
  const auto card = score(*params, options.linearisation, progress);
  if (!card) return request.document.locate(card.error());
  const auto sweep = sweep_two_port(*params, options.linearisation);
  if (!sweep) return request.document.locate(sweep.error());

  const report::Table table = card_table(*card, *params), changes = sensitivity_table(*card);
  const report::Figure figure = two_port_figure(*sweep);
  const std::string limited = limited_by(*card);
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  nlohmann::ordered_json document{{"experiment", request.name},
                                  {"gain_limit", number(card->limit.force_gain)},
                                  {"gain_limit_at_Hz", card->limit.frequency_rad_per_s / turn},
                                  {"gain_limit_without_cancellation", number(card->uncancelled.force_gain)},
                                  {"mass_ratio", card->mass_ratio},
                                  {"force_bandwidth_Hz", number(card->force_bandwidth_Hz.value_or(INFINITY))},
                                  {"force_peak", card->force_peak},
                                  {"force_peak_Hz", card->force_peak_Hz},
                                  {"effort_2_Hz_N_s_per_m", card->effort_2_Hz_N_s_per_m},
                                  {"effort_10_Hz_N_s_per_m", card->effort_10_Hz_N_s_per_m},
                                  {"sensitivities", nlohmann::ordered_json::object()}};
  const VirtualWalls walls = virtual_walls(*params);
  document["virtual_walls_N_per_m"] = {{"passive", number(walls.passive_N_per_m)},
                                       {"passive_quantised", number(walls.quantised_N_per_m)},
                                       {"stable_with_delay", number(walls.stable_N_per_m)},
                                       {"comes_to_rest", number(walls.rest_N_per_m)},
                                       {"small_motion_comes_to_rest", number(walls.small_rest_N_per_m)}};
  for (const Sensitivity& s : card->sensitivities) document["sensitivities"][s.key] = number(s.limit_change);

  report::Page page(request.name + ": scorecard of the master");
  page.paragraph(limited);
  page.paragraph(
      "How much force gain the master allows before its induced motion closes an unstable loop, how well its "
      "force reaches the hand, and what it costs to move it. Linear, in contact.");
  page.table(table);
  page.table(changes);
  page.figure(figure);
  return experiments::outcome_of({.text = limited + "\n" + table.to_text() + changes.to_text(),
                                  .json = report::json_text(document),
                                  .page = std::move(page),
                                  .figures = {figure}},
                                 request, configuration::to_toml(*params));
}

}  // namespace tactus::stability
