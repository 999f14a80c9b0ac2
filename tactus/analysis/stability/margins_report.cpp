// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/margins.hpp>
#include <tactus/analysis/stability/margins_report.hpp>
#include <tactus/analysis/stability/uncertainty.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

namespace tactus::stability {

namespace {

/// Poles of a longer closed loop are counted and not listed: the time for a list grows with the cube.
constexpr Eigen::Index most_listed_states = 400;

/// One line of the table and one entry of the JSON document.
struct Quantity {
  std::string key, words, unit;
  double value;
  double shown;  ///< in `unit`
  std::optional<double> frequency_Hz = std::nullopt;
};

struct Analysis {
  Loop loop;
  LoopCurve curve;
  std::vector<Quantity> quantities;
  std::vector<std::complex<double>> slowest;
};

std::optional<double> in_Hz(double frequency_rad_per_s) {
  if (frequency_rad_per_s > 0.0) return frequency_rad_per_s / turn;
  return std::nullopt;
}

/// The closed-loop poles that decay the slowest, of each pair the upper one.
std::vector<std::complex<double>> slowest_poles(const Loop& loop) {
  const StateSpace closed = loop.closed(loop.force_gain);
  if (closed.states() > most_listed_states) return {};
  std::vector<std::complex<double>> found;
  for (const std::complex<double> pole : poles(closed)) {
    if (pole.imag() >= 0.0) found.push_back(pole);
  }
  std::sort(found.begin(), found.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
  found.resize(std::min<std::size_t>(found.size(), 8));
  return found;
}

Result<Analysis> analyse(const experiments::TappingParams& params, const ReportOptions& options) {
  auto made = make_loop(params, options.linearisation);
  if (!made) return made.error();
  const auto uncertain = uncertain_limit(params, options.linearisation, options.uncertainty);
  if (!uncertain) return uncertain.error();
  Analysis analysis{.loop = *std::move(made), .curve = {}, .quantities = {}, .slowest = {}};
  const Loop& loop = analysis.loop;
  analysis.curve = trace(loop);
  analysis.slowest = slowest_poles(loop);
  const LoopCurve& curve = analysis.curve;
  const GainLimit limit = gain_limit(loop);
  const GainMargin gain = gain_margin(curve);
  const PhaseMargin phase = phase_margin(curve);
  const ModulusMargin modulus = modulus_margin(curve);
  const DiskMargin disk = disk_margin(curve);
  const bool alone = stable_without_force(loop);
  const int unstable = unstable_poles(curve);
  const bool stable = alone && unstable == 0;
  // Of an unstable loop none of the other margins says how far it is from anything.
  const auto margin = [stable](double value) { return stable ? value : std::nan(""); };
  const auto where = [stable](double frequency_rad_per_s) {
    return stable ? in_Hz(frequency_rad_per_s) : std::nullopt;
  };
  auto& q = analysis.quantities;
  q.push_back({"force_gain", "force gain", "", loop.force_gain, loop.force_gain});
  q.push_back({"gain_limit", "gain limit", "", limit.force_gain, limit.force_gain, in_Hz(limit.frequency_rad_per_s)});
  q.push_back({"stable", "stable (1 yes, 0 no)", "", stable ? 1.0 : 0.0, stable ? 1.0 : 0.0});
  if (alone) q.push_back({"unstable_poles", "unstable poles", "", double(unstable), double(unstable)});
  q.push_back({"gain_margin", "gain margin, a factor", "", gain.factor, gain.factor, in_Hz(gain.frequency_rad_per_s)});
  q.push_back({"phase_margin_rad", "phase margin", "degrees", margin(phase.phase_rad), margin(degree * phase.phase_rad),
               where(phase.phase_frequency_rad_per_s)});
  q.push_back({"delay_margin_s", "delay margin", "ms", margin(phase.delay_s), margin(1e3 * phase.delay_s),
               where(phase.delay_frequency_rad_per_s)});
  q.push_back({"modulus_margin", "modulus margin", "", margin(modulus.distance), margin(modulus.distance),
               where(modulus.frequency_rad_per_s)});
  q.push_back({"disk_margin", "disk margin alpha", "", margin(disk.alpha), margin(disk.alpha),
               where(disk.frequency_rad_per_s)});
  q.push_back({"disk_gain_factor", "gain that it allows, a factor", "", margin(disk.gain_factor()),
               margin(disk.gain_factor())});
  q.push_back({"disk_phase_rad", "phase that it allows", "degrees", margin(disk.phase_rad()),
               margin(degree * disk.phase_rad())});
  const double mass_limit = mass_ratio(params) / loop.position_scale;
  q.push_back({"daniel_mcaree_limit", "Daniel and McAree: mass ratio over lambda", "", mass_limit, mass_limit});
  q.push_back({"small_gain_limit", "small-gain limit, model wrong by the share", "", uncertain->small_gain,
               uncertain->small_gain, in_Hz(uncertain->small_gain_frequency_rad_per_s)});
  q.push_back({"worst_model_limit", "smallest gain limit, model wrong by the share", "", uncertain->smallest_limit,
               uncertain->smallest_limit});
  return analysis;
}

std::string number_or_none(double value) { return std::isfinite(value) ? report::number(value, 5) : "none"; }

report::Table table_of(const Analysis& analysis) {
  report::Table table({{"quantity", "", report::Column::Align::left},
                       {"value"},
                       {"unit", "", report::Column::Align::left},
                       {"at", "Hz"}},
                      "Loop of induced master motion, linear, in contact");
  for (const Quantity& q : analysis.quantities) {
    table.add_row({q.words, number_or_none(q.shown), q.unit, q.frequency_Hz ? report::number(*q.frequency_Hz, 4) : ""});
  }
  return table;
}

std::string verdict_of(const Analysis& analysis) {
  const auto value = [&analysis](std::string_view key) {
    for (const Quantity& q : analysis.quantities) {
      if (q.key == key) return q.value;
    }
    return std::nan("");
  };
  const double limit = value("gain_limit");
  const std::string at = " at a force gain of " + report::number(value("force_gain"), 3);
  const std::string up_to =
      std::isfinite(limit) ? "; the limit is " + report::number(limit, 3) + "." : "; no gain makes it unstable.";
  return (value("stable") > 0.0 ? "Stable" : "Unstable") + at + up_to;
}

/// Says so if the model is that of another master: the margins are those of `[master]`, whatever device was identified.
std::string note_on_model(const experiments::TappingParams& params) {
  constexpr double largest_ratio = 1.5;
  const auto moving_kg = [](const auto& of, const auto& end) {
    return of.motor.mass_kg + of.drum.mass_kg + end.mass_kg;
  };
  const double model_kg = moving_kg(params.control.model, params.control.model.handle);
  const double master_kg = moving_kg(params.master.mechanism, params.master.mechanism.tip);
  if (model_kg <= largest_ratio * master_kg && master_kg <= largest_ratio * model_kg) return {};
  return " The model moves " + report::number(model_kg, 3) + " kg and [master] " + report::number(master_kg, 3) +
         " kg: these figures are those of the master in [master]. If the model is that of your device, describe your "
         "device under [master] too.";
}

report::Table pole_table(const Analysis& analysis) {
  report::Table table({{"magnitude"}, {"frequency", "Hz"}, {"decays with", "ms"}}, "Slowest closed-loop poles");
  for (const std::complex<double> pole : analysis.slowest) {
    const double time_s = -analysis.loop.tick_s / std::log(std::abs(pole));
    table.add_row({report::number(std::abs(pole), 7), report::number(std::arg(pole) / turn / analysis.loop.tick_s, 4),
                   time_s > 0.0 && std::isfinite(time_s) ? report::number(1e3 * time_s, 4) : "never"});
  }
  return table;
}

std::vector<report::Figure> figures_of(const Analysis& analysis) {
  const LoopCurve& curve = analysis.curve;
  std::vector<double> frequency_Hz, decibel, phase_degrees, real, imaginary;
  double phase = 0.0;
  std::complex<double> before = 1.0;
  for (std::size_t i = 0; i < curve.gain.size(); ++i) {
    const std::complex<double> gain = curve.gain[i];
    phase += std::arg(gain * std::conj(before));
    before = gain;
    frequency_Hz.push_back(curve.frequency_rad_per_s[i] / turn);
    decibel.push_back(20.0 * std::log10(std::abs(gain)));
    phase_degrees.push_back(degree * phase);
    real.push_back(gain.real());
    imaginary.push_back(gain.imag());
  }
  const double worst_dB = *std::max_element(decibel.begin(), decibel.end());
  const report::Axis hertz{.label = "frequency", .unit = "Hz", .lower = 1.0, .scale = report::Axis::Scale::logarithmic};
  const report::Axis level{.label = "gain", .unit = "dB", .lower = worst_dB - 80.0};
  const report::Axis angle{.label = "phase", .unit = "degrees"};
  const report::Rule unity{.at = 0.0, .label = "gain 1"};
  report::Figure bode{
      .title = "Bode", .caption = "The loop gain over frequency, delays exact.", .columns = 1, .panels = {}};
  bode.panels.push_back({"", hertz, level, {{"", frequency_Hz, decibel}}, {unity}});
  bode.panels.push_back({"", hertz, angle, {{"", frequency_Hz, phase_degrees}}, {}});
  const double reach = std::clamp(1.2 * std::pow(10.0, worst_dB / 20.0), 1.5, 5.0);
  report::Figure nyquist{.title = "Nyquist",
                         .caption = "The loop gain in the complex plane; the cross of the rules is -1.",
                         .columns = 1,
                         .panels = {}};
  nyquist.panels.push_back(
      {"",
       {.label = "real part", .lower = -reach, .upper = reach},
       {.label = "imaginary part", .lower = -reach, .upper = reach},
       {{"", real, imaginary}},
       {{report::Rule::Direction::vertical, -1.0, ""}, {report::Rule::Direction::horizontal, 0.0, ""}}});
  report::Figure nichols{
      .title = "Nichols",
      .caption = "Gain over phase; the critical points are at 0 dB and odd multiples of 180 degrees.",
      .columns = 1,
      .panels = {}};
  nichols.panels.push_back({"", angle, level, {{"", phase_degrees, decibel}}, {unity}});
  return {bode, nyquist, nichols};
}

std::string json_of(const experiments::Request& request, const ReportOptions& options, const Analysis& analysis) {
  nlohmann::ordered_json document{{"experiment", request.name}, {"uncertainty", options.uncertainty}};
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  for (const Quantity& q : analysis.quantities) {
    document[q.key] = number(q.value);
    if (q.frequency_Hz) document[q.key + "_at_Hz"] = *q.frequency_Hz;
  }
  auto& listed = document["slowest_poles"] = nlohmann::ordered_json::array();
  for (const std::complex<double> pole : analysis.slowest) listed.push_back({pole.real(), pole.imag()});
  return report::json_text(document);
}

}  // namespace

Result<experiments::Outcome> report_margins(const experiments::Request& request, const ReportOptions& options) {
  const auto params = request.document.read<experiments::TappingParams>();
  if (!params) return params.error();
  const auto analysis = analyse(*params, options);
  if (!analysis) return request.document.locate(analysis.error());
  const report::Table table = table_of(*analysis), slowest = pole_table(*analysis);
  std::vector<report::Figure> figures = figures_of(*analysis);
  report::Page page(request.name + ": stability margins");
  const std::string said = verdict_of(*analysis) + note_on_model(*params);
  page.paragraph(said);
  page.paragraph(
      "The force that the slave feels moves the master's motor; what of that motion cancellation leaves goes to the "
      "slave as a command. This loop, linear and sampled, is judged here with the tip on the wall. It does not see "
      "contact that breaks, saturation, quantisation, or friction that sticks.");
  page.table(table);
  page.table(slowest);
  for (const report::Figure& figure : figures) page.figure(figure);
  std::string text = said + "\n\n" + table.to_text();
  text += analysis->slowest.empty()
              ? "Poles: too many for a list; unstable ones are counted by the argument principle\n"
              : slowest.to_text();
  return experiments::outcome_of({.text = std::move(text),
                                  .json = json_of(request, options, *analysis),
                                  .page = std::move(page),
                                  .figures = std::move(figures)},
                                 request, configuration::to_toml(*params));
}

}  // namespace tactus::stability
