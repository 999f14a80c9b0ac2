#include <tactus/report/text.hpp>
#include <tactus/simulation/contest.hpp>
#include <tactus/simulation/presentation.hpp>
#include <tactus/simulation/tapping.hpp>
#include <tactus/stability/bonded_run.hpp>
#include <tactus/stability/limit_report.hpp>
#include <tactus/stability/margins.hpp>
#include <tactus/stability/uncertainty.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

namespace tactus::stability {

namespace {

constexpr double lowest_gain = 0.05;
constexpr double highest_gain = 1000.0;
/// Highest gain that taps are tried with, as in the contest: what settles there settles for every purpose.
constexpr double highest_tapped = 32.0;

struct Rung {
  std::string key, words, adds;
  simulation::GainLimit limit;
};

std::string shown(const simulation::GainLimit& limit) {
  return (limit.beyond_search ? "> " : "") + report::number(limit.gain, 4);
}

simulation::GainLimit tapped(simulation::TappingParams params) {
  return simulation::find_gain_limit(lowest_gain, highest_tapped, [&params](double gain) {
    params.control.force_gain = gain;
    return simulation::taps_settle(params);
  });
}

/// Friction and hysteresis off in devices and model, sensors ideal; the wall, the person and the limits as they are.
simulation::TappingParams frictionless(simulation::TappingParams params) {
  const simulation::TappingParams file = params;
  static_cast<simulation::Teleoperator::Params&>(params) = linear_version(params);
  params.environment = file.environment;
  params.person = file.person;
  params.channel = file.channel;
  params.control.model.hand.quintic_stiffness_N_per_m5 = file.control.model.hand.quintic_stiffness_N_per_m5;
  return params;
}

}  // namespace

Result<simulation::Outcome> report_limit(const simulation::Request& request, const ReportOptions& options,
                                         const simulation::Progress& progress) {
  const auto params = request.document.read<simulation::TappingParams>();
  if (!params) return params.error();
  const auto loop = make_loop(*params, options.linearisation);
  if (!loop) return request.document.locate(loop.error());
  const simulation::TappingParams ideal = frictionless(*params);
  for (const simulation::TappingParams& taps : {*params, ideal}) {
    if (const auto ensemble = simulation::TappingEnsemble::make(taps); !ensemble) {
      return request.document.locate(ensemble.error());
    }
  }
  const simulation::Teleoperator::Params bonded = linear_version(*params, options.linearisation.preload_N);
  if (const auto teleoperator = simulation::Teleoperator::make(bonded, 0.0); !teleoperator) {
    return request.document.locate(teleoperator.error());
  }

  const auto wrong = uncertain_limit(*params, options.linearisation, params->task.model_error);
  if (!wrong) return request.document.locate(wrong.error());
  const GainLimit linear = gain_limit(*loop);
  const bool endless = std::isinf(linear.force_gain);
  std::vector<Rung> rungs;
  rungs.push_back({"linear",
                   "linear loop, sampled",
                   "",
                   {.gain = endless ? highest_gain : linear.force_gain, .beyond_search = endless}});
  rungs.push_back({"bonded", "the same in time, tip glued on", "plants stepped, not solved",
                   bisect_linear_limit(bonded, lowest_gain, highest_gain)});
  rungs.push_back(
      {"wrong_models",
       "linear loop, worst model",
       "a model that does not fit",
       {.gain = std::min(wrong->smallest_limit, highest_gain), .beyond_search = wrong->smallest_limit > highest_gain}});
  if (progress) progress(0.1);
  rungs.push_back(
      {"taps_without_friction", "taps without friction", "contact that breaks, saturation, the judge", tapped(ideal)});
  if (progress) progress(0.5);
  rungs.push_back({"taps", "taps as in the file", "friction, hysteresis, noise, quantisation", tapped(*params)});
  if (progress) progress(1.0);

  report::Table table({{"gain limit of", "", report::Column::Align::left},
                       {"force gain"},
                       {"over the one above"},
                       {"what comes in", "", report::Column::Align::left}},
                      "Gain limit, linear and in time");
  nlohmann::ordered_json document{{"experiment", request.name},
                                  {"linear_frequency_Hz", linear.frequency_rad_per_s / (2.0 * std::numbers::pi)},
                                  {"limits", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < rungs.size(); ++i) {
    const double ratio = i > 0 ? rungs[i].limit.gain / rungs[i - 1].limit.gain : 1.0;
    table.add_row(
        {rungs[i].words, shown(rungs[i].limit),
         i > 0 && std::isfinite(ratio) ? (rungs[i].limit.beyond_search ? "> " : "") + report::number(ratio, 4) : "",
         rungs[i].adds});
    document["limits"].push_back(
        {{"of", rungs[i].key}, {"force_gain", rungs[i].limit.gain}, {"beyond_search", rungs[i].limit.beyond_search}});
  }
  const auto farthest = std::max_element(rungs.begin() + 1, rungs.end(), [](const Rung& a, const Rung& b) {
    const auto gap = [](const Rung& rung) {
      const double before = (&rung - 1)->limit.gain;
      return before > 0.0 && rung.limit.gain > 0.0 ? std::fabs(std::log(rung.limit.gain / before)) : 1e9;
    };
    return gap(a) < gap(b);
  });
  const std::string reason =
      "Most of the gap comes in with: " + farthest->adds +
      ".\nWorst model: of 27 wrong by task.model_error. Taps without friction: nor hysteresis, with "
      "ideal sensors. The judge: settled within 100 ms.\n";
  document["largest_gap"] = farthest->key;

  report::Page page(request.name + ": gain limit");
  page.paragraph(
      "The largest force gain up to which the contact calms down, from the linear loop to the taps of the file. "
      "Each row adds something that the row above does not have. A > marks the end of the search.");
  page.table(table);
  page.paragraph(reason);
  simulation::add_provenance(page, request, configuration::to_toml(*params));
  return simulation::Outcome{
      .text = table.to_text() + reason, .json = document.dump(2) + "\n", .html = page.to_html(), .figures = {}};
}

}  // namespace tactus::stability
