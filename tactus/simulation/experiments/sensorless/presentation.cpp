// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/internal/gain_json.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/sensorless/presentation.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::experiments {

namespace {

using Json = nlohmann::ordered_json;

constexpr double not_drawn = std::numeric_limits<double>::quiet_NaN();

std::string delay_text(double delay_s) {
  return delay_s == 0.0 ? "no delay" : format_number(1e3 * delay_s) + " ms each way";
}

std::string in_milli(const std::optional<double>& value) { return value ? report::number(1e3 * *value, 3) : "–"; }

/// Median settling time, as long as it is a time and not the end of the observation.
std::optional<double> settling_time_s(const GainScore& score) {
  if (score.metrics.settled_fraction <= 0.5) return {};
  return score.metrics.settling_time_median_s;
}

/// The error at the hand says something only of taps that settle.
std::optional<double> hand_error(const GainScore& score) {
  return score.metrics.settled_fraction >= 0.95 ? score.spectral_error : std::nullopt;
}

std::size_t row_of(std::size_t delay, std::size_t choice, std::size_t mode) {
  return (delay * force_choices.size() + choice) * sensorless_cancellation.size() + mode;
}

}  // namespace

report::Table sensorless_table(const std::vector<SensorlessCase>& rows, const std::vector<SensorlessScore>& scores,
                               const SensorlessParams& params) {
  using Align = report::Column::Align;
  report::Table table({{"source of the slave's force", "", Align::left},
                       {"delay", "ms"},
                       {"cancellation", "", Align::left},
                       {"settled", "%"},
                       {"settling", "ms"},
                       {"hand error", "%"},
                       {"force error", "mN RMS"},
                       {"false force", "mN RMS"},
                       {"gain limit"},
                       {"at " + format_number(params.task.strong_display_N) + " N"}},
                      "How much force gain can be had without a force sensor");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const SensorlessScore& score = scores[i];
    table.add_row({std::string(force_choices[rows[i].choice].name), format_number(1e3 * rows[i].delay_s),
                   std::string(name_of(rows[i].cancellation)),
                   report::number(100.0 * score.at_gain.metrics.settled_fraction, 3),
                   in_milli(settling_time_s(score.at_gain)), percent(hand_error(score.at_gain)),
                   in_milli(score.at_gain.sent_force_error_N), in_milli(score.free_space.displayed_force_rms_N),
                   gain_limit_text(score.limit, params.task.lowest_gain),
                   gain_limit_text(score.strong_display, params.task.lowest_gain)});
  }
  return table;
}

std::vector<std::string> sensorless_verdicts(const std::vector<SensorlessCase>& rows,
                                             const std::vector<SensorlessScore>& scores,
                                             const SensorlessParams& params) {
  std::vector<std::string> sentences;
  for (std::size_t delay = 0; delay < sensorless_delays_s.size(); ++delay) {
    for (std::size_t mode = 0; mode < sensorless_cancellation.size(); ++mode) {
      const auto limit = [&](std::size_t choice) -> const GainLimit& {
        return scores[row_of(delay, choice, mode)].strong_display;
      };
      const auto text = [&](std::size_t choice) { return gain_limit_text(limit(choice), params.task.lowest_gain); };
      std::size_t best = 1;
      for (std::size_t choice = 2; choice < force_choices.size(); ++choice) {
        if (limit(choice).gain > limit(best).gain) best = choice;
      }
      std::string best_names;
      for (std::size_t choice = 1; choice < force_choices.size(); ++choice) {
        if (limit(choice).gain != limit(best).gain) continue;
        best_names += (best_names.empty() ? "" : "; ") + std::string(force_choices[choice].name);
      }
      const SensorlessCase& row = rows[row_of(delay, 0, mode)];
      sentences.push_back("Display up to " + format_number(params.task.strong_display_N) + " N, " +
                          delay_text(row.delay_s) + ", cancellation " + std::string(name_of(row.cancellation)) +
                          ": gain limit " + text(0) + " with the sensor, " + text(best) + " without (" + best_names +
                          "); prediction takes the inverse model from " + text(1) + " to " + text(2) + ".");
    }
  }
  return sentences;
}

report::Figure sensorless_figure(const std::vector<SensorlessCase>& rows, const std::vector<SensorlessScore>& scores,
                                 const SensorlessParams& params) {
  std::vector<std::string> names;
  for (const ForceChoice& choice : force_choices) names.emplace_back(choice.name);
  using Value = std::function<std::pair<std::optional<double>, std::string>(const SensorlessScore&)>;
  const auto panel = [&](std::string title, std::size_t delay, report::Axis x, const Value& value) {
    std::vector<report::Bars> all;
    double longest = 0.0;
    for (std::size_t mode = 0; mode < sensorless_cancellation.size(); ++mode) {
      const std::string name = "cancellation " + std::string(name_of(sensorless_cancellation[mode]));
      report::Bars bars{.name = name, .lengths = {}, .colour = static_cast<int>(mode)};
      for (std::size_t choice = 0; choice < force_choices.size(); ++choice) {
        const auto [length, label] = value(scores[row_of(delay, choice, mode)]);
        bars.lengths.push_back(length.value_or(not_drawn));
        bars.labels.push_back(label);
        longest = std::max(longest, length.value_or(0.0));
      }
      all.push_back(std::move(bars));
    }
    // Room for the labels behind the bars.
    x.upper = (x.scale == report::Axis::Scale::logarithmic ? 3.0 : 1.3) * longest;
    return report::Panel{.title = std::move(title),
                         .x = std::move(x),
                         .y = {.label = "", .categories = names},
                         .lines = {},
                         .rules = {},
                         .bars = std::move(all)};
  };
  report::Figure figure{
      .title = "Force gain without a force sensor, and what it costs",
      .caption =
          "Above: the largest gain that settles, display up to " + format_number(params.task.strong_display_N) +
          " N. Below, without delay, at gain " + format_number(params.control.force_gain) +
          ": what the hand is shown where there is nothing, how far the slave's force is off in contact, and what "
          "the hand misses of the touch.",
      .columns = 3,
      .panels = {},
      .share_y = report::Sharing::in_line};
  const report::Axis gain{
      .label = "force gain", .lower = 0.5 * params.task.lowest_gain, .scale = report::Axis::Scale::logarithmic};
  for (std::size_t delay = 0; delay < sensorless_delays_s.size(); ++delay) {
    const double delay_s = rows[row_of(delay, 0, 0)].delay_s;
    figure.panels.push_back(panel("gain limit, " + delay_text(delay_s), delay, gain, [&](const SensorlessScore& score) {
      const GainLimit& limit = score.strong_display;
      return std::pair(limit.gain > 0.0 ? std::optional(limit.gain) : std::nullopt,
                       gain_limit_text(limit, params.task.lowest_gain));
    }));
  }
  const auto milli = [](std::optional<double> value) {
    if (value) *value *= 1e3;
    return std::pair(value, value ? report::number(*value, 3) : std::string("never touched"));
  };
  figure.panels.push_back(panel("false force in free motion", 0, {.label = "displayed force", .unit = "mN RMS"},
                                [&](const SensorlessScore& s) { return milli(s.free_space.displayed_force_rms_N); }));
  figure.panels.push_back(panel("force error in contact", 0, {.label = "slave's force", .unit = "mN RMS"},
                                [&](const SensorlessScore& s) { return milli(s.at_gain.sent_force_error_N); }));
  figure.panels.push_back(
      panel("error at the hand", 0, {.label = "spectral error", .unit = "%"}, [&](const SensorlessScore& score) {
        std::optional<double> error = hand_error(score.at_gain);
        std::string label = error ? percent(error) : std::string("does not settle");
        if (error) *error *= 100.0;
        return std::pair(error, std::move(label));
      }));
  return figure;
}

std::string sensorless_json(const std::string& experiment, const std::vector<SensorlessCase>& rows,
                            const std::vector<SensorlessScore>& scores, const SensorlessParams& params) {
  Json document{{"experiment", experiment},
                {"force_gain", params.control.force_gain},
                {"force_limit_N", params.control.force_limit_N},
                {"lowest_gain", params.task.lowest_gain},
                {"highest_gain", params.task.highest_gain},
                {"rows", Json::array()}};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const SensorlessScore& score = scores[i];
    const control::SlaveForce::Params& force = rows[i].params.control.slave_force;
    Json row{{"source", name_of(force.source)}};
    if (force.source == control::SlaveForceSource::inverse_model) {
      row["prediction_blocks"] = force.inverse_model.prediction.blocks;
    }
    Json strong{{"force_limit_N", params.task.strong_display_N}};
    strong.update(json_of(score.strong_display));
    row.update({{"delay_s", rows[i].delay_s}, {"cancellation", name_of(rows[i].cancellation)}});
    row.update(json_of(score.limit));
    row.update(json_of_settling(score.at_gain.metrics));
    row.update({{"strong_display", strong},
                {"spectral_error", json_of(score.at_gain.spectral_error)},
                {"force_error_rms_N", json_of(score.at_gain.sent_force_error_N)},
                {"free_space_displayed_force_rms_N", score.free_space.displayed_force_rms_N}});
    document["rows"].push_back(std::move(row));
  }
  return report::json_text(document);
}

}  // namespace tactus::experiments
