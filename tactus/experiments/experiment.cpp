#include <tactus/experiments/contest/experiment.hpp>
#include <tactus/experiments/experiment.hpp>
#include <tactus/experiments/faults/experiment.hpp>
#include <tactus/experiments/force_display/experiment.hpp>
#include <tactus/experiments/force_estimators/experiment.hpp>
#include <tactus/experiments/hydraulic_chirp/experiment.hpp>
#include <tactus/experiments/hydraulic_rigid_contact/experiment.hpp>
#include <tactus/experiments/inverse_model_chirp/experiment.hpp>
#include <tactus/experiments/prediction_block/experiment.hpp>
#include <tactus/experiments/sensorless/experiment.hpp>
#include <tactus/experiments/tapping/experiment.hpp>

#include <algorithm>
#include <array>

namespace tactus::experiments {

namespace {

constexpr std::size_t most_combinations = 100'000;

Error bad_variation(std::string_view text, const std::string& why) {
  return {.code = ErrorCode::syntax,
          .parameter = {},
          .message = why + ": write key=value,value,..., for instance control.force_gain=1,3,5",
          .place = "--vary " + std::string(text)};
}

}  // namespace

Result<Variation> parse_variation(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) return bad_variation(text, "there is no '='");
  if (equals == 0) return bad_variation(text, "there is no key before '='");
  Variation variation{.key = std::string(text.substr(0, equals)), .values = {}};
  std::string_view rest = text.substr(equals + 1);
  for (bool more = true; more;) {
    const auto comma = rest.find(',');
    more = comma != std::string_view::npos;
    const std::string_view value = rest.substr(0, comma);
    if (value.empty()) return bad_variation(text, "a value is empty");
    variation.values.emplace_back(value);
    if (more) rest.remove_prefix(comma + 1);
  }
  return variation;
}

Result<std::vector<Settings>> combinations(const std::vector<Variation>& variations) {
  std::vector<Settings> all{{}};
  for (const Variation& variation : variations) {
    const auto same_key = [&](const Variation& other) { return other.key == variation.key; };
    if (std::count_if(variations.begin(), variations.end(), same_key) > 1) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = variation.key,
                   .message = "is varied twice: give all its values in one --vary",
                   .place = "--vary"};
    }
    if (all.size() * variation.values.size() > most_combinations) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = variation.key,
                   .message = "more than " + std::to_string(most_combinations) + " combinations: vary fewer values",
                   .place = "--vary"};
    }
    std::vector<Settings> longer;
    for (const Settings& settings : all) {
      for (const std::string& value : variation.values) {
        longer.push_back(settings);
        longer.back().emplace_back(variation.key, value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

Error blame_variation(Error error, const Settings& settings) {
  constexpr std::string_view set = "--set ";
  for (const auto& setting : settings) {
    if (error.place.starts_with(std::string(set) + setting.first + "=")) {
      error.place.replace(0, set.size(), "--vary ");
      break;
    }
  }
  return error;
}

std::span<const Experiment* const> experiments() {
  static const TappingExperiment tapping;
  static const ForceDisplayExperiment force_display;
  static const ContestExperiment contest;
  static const InverseModelChirpExperiment inverse_model_chirp;
  static const PredictionBlockExperiment prediction_block;
  static const ForceEstimatorsExperiment force_estimators;
  static const HydraulicChirpExperiment hydraulic_chirp;
  static const HydraulicRigidContactExperiment hydraulic_rigid_contact;
  static const SensorlessExperiment sensorless;
  static const FaultExperiment faults;
  static constexpr auto all = std::to_array<const Experiment*>(
      {&tapping, &force_display, &contest, &inverse_model_chirp, &prediction_block, &force_estimators, &hydraulic_chirp,
       &hydraulic_rigid_contact, &sensorless, &faults});
  return all;
}

Result<const Experiment*> choose_experiment(const configuration::Document& document) {
  const auto kind = document.text_at("task.kind");
  if (!kind) return kind.error();
  std::string known;
  for (const Experiment* experiment : experiments()) {
    if (experiment->kind() == *kind) return experiment;
    known += (known.empty() ? "" : ", ") + std::string(experiment->kind());
  }
  return document.locate({.code = ErrorCode::out_of_bounds,
                          .parameter = "task.kind",
                          .message = "'" + *kind + "' is no kind of experiment: write one of " + known,
                          .place = {}});
}

}  // namespace tactus::experiments
