// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/knowledge.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::advice {

namespace {

using experiments::TappingParams;

/// The slip deflections of the two laws of hysteresis at which their loops have the same area (`BoucWenSpring`).
constexpr double bouc_wen_over_elasto_slip = 0.65;
constexpr double most_hysteretic = 0.98;
/// Neither an amplifier nor a person is faster: what is left of a lag by what else is in it may come out at nothing.
constexpr double shortest_lag_s = 1e-5;

double lag_s(double bandwidth_Hz) { return 1.0 / (2.0 * std::numbers::pi * bandwidth_Hz); }

}  // namespace

const std::vector<Knowledge::Place>& Knowledge::places() {
  using enum Scale;
  using Rig = TappingParams;
  static const std::vector<Place> all{
      {"amplifier.gain", "master.amplifier.gain", logarithm,
       [](Rig& rig, double value) { rig.master.amplifier.gain = value; }},
      {"amplifier.bandwidth_Hz", "master.amplifier.bandwidth_Hz", logarithm,
       [](Rig& rig, double value) { rig.master.amplifier.bandwidth_Hz = value; }},
      // Holds the delay of the computation too, which the file states.
      {"amplifier.lag_s", "master.amplifier.bandwidth_Hz", logarithm,
       [](Rig& rig, double value) {
         rig.master.amplifier.bandwidth_Hz = lag_s(std::max(value - rig.servo.computation_delay_s, shortest_lag_s));
       }},
      {"motor.mass_kg", "master.mechanism.motor.mass_kg", logarithm,
       [](Rig& rig, double value) { rig.master.mechanism.motor.mass_kg = value; }},
      {"motor.friction_N", "master.mechanism.motor.friction_N", logarithm,
       [](Rig& rig, double value) { rig.master.mechanism.motor.friction_N = value; }},
      {"cable.stiffness_N_per_m", "master.mechanism.cable.stiffness_N_per_m", logarithm,
       [](Rig& rig, double value) { rig.master.mechanism.cable.stiffness_N_per_m = value; }},
      {"cable.damping_N_s_per_m", "master.mechanism.cable.damping_N_s_per_m", logarithm,
       [](Rig& rig, double value) { rig.master.mechanism.cable.damping_N_s_per_m = value; }},
      {"drum.mass_kg", "master.mechanism.drum.mass_kg", logarithm,
       [](Rig& rig, double value) { rig.master.mechanism.drum.mass_kg = value; }},
      {"drum.friction_N", "master.mechanism.drum.friction_N", logarithm,
       [](Rig& rig, double value) { rig.master.mechanism.drum.friction_N = value; }},
      {"linkage.stiffness_N_per_m", "master.mechanism.linkage.stiffness_N_per_m", logarithm,
       [](Rig& rig, double value) {
         rig.master.mechanism.linkage.stiffness_N_per_m = value;
         rig.master.mechanism.linkage.reference_deflection_m = rig.control.model.linkage.reference_deflection_m;
       }},
      {"linkage.hysteretic_fraction", "master.mechanism.linkage.hysteretic_fraction", odds,
       [](Rig& rig, double value) {
         rig.master.mechanism.linkage.hysteretic_fraction = std::min(value, most_hysteretic);
       }},
      {"linkage.slip_deflection_m", "master.mechanism.linkage.slip_deflection_m", logarithm,
       [](Rig& rig, double value) {
         rig.master.mechanism.linkage.slip_deflection_m = value / bouc_wen_over_elasto_slip;
       }},
      {"linkage.damping_N_s_per_m", "master.mechanism.linkage.damping_N_s_per_m", linear,
       [](Rig& rig, double value) { rig.master.mechanism.linkage.damping_N_s_per_m = std::max(value, 0.0); }},
      {"handle.mass_kg", "master.mechanism.tip.mass_kg", logarithm,
       [](Rig& rig, double value) { rig.master.mechanism.tip.mass_kg = value; }},
      {"operator.stiffness_N_per_m", "operator.grip.stiffness_N_per_m", logarithm,
       [](Rig& rig, double value) { rig.person.grip.stiffness_N_per_m = value; }},
      {"operator.damping_N_s_per_m", "operator.grip.damping_N_s_per_m", logarithm,
       [](Rig& rig, double value) { rig.person.grip.damping_N_s_per_m = value; }},
      {"operator.correction_gain_per_s", "operator.correction.gain_per_s", logarithm,
       [](Rig& rig, double value) { rig.person.correction.gain_per_s = std::min(value, 8.0); }},
      // Holds the lag of the person's sight too, which the file states.
      {"operator.reaction_time_s", "operator.correction.reaction_time_s", logarithm,
       [](Rig& rig, double value) {
         rig.person.correction.reaction_time_s =
             std::clamp(value - lag_s(rig.person.correction.bandwidth_Hz), 0.0, 0.4);
       }},
      {"task.mismatch.mass", "", even, [](Rig& rig, double value) { rig.task.mismatch.mass *= value; }},
      {"task.mismatch.linkage_stiffness", "", even,
       [](Rig& rig, double value) { rig.task.mismatch.linkage_stiffness *= value; }},
      {"task.mismatch.operator_damping", "", even,
       [](Rig& rig, double value) { rig.task.mismatch.operator_damping *= value; }},
  };
  return all;
}

void Knowledge::add(const Place& place, Uncertain parameter, double deviation) {
  parameters_.push_back(std::move(parameter));
  places_.push_back(place);
  deviation_.push_back(deviation);
}

void Knowledge::set_correlation(const std::function<double(std::size_t, std::size_t)>& of) {
  const auto size = static_cast<Eigen::Index>(parameters_.size());
  if (size == 0) return;
  Eigen::MatrixXd covariance(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      covariance(i, j) = deviation_[a] * deviation_[b] * (i == j ? 1.0 : 0.5 * (of(a, b) + of(b, a)));
    }
  }
  // Parts that were fitted in turn need not make a whole that is a covariance: what is below nothing is nothing.
  const signal::SymmetricEigen eigen = signal::symmetric_eigen(covariance);
  const Eigen::MatrixXd root = eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal().toDenseMatrix();
  const Eigen::MatrixXd whole = root * root.transpose();
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      root_.push_back(root(i, j));
      covariance_.push_back(whole(i, j));
    }
  }
}

Knowledge Knowledge::identified(std::span<const identification::FoundParameter> found,
                                std::span<const double> correlation, const Conditions& given) {
  Knowledge knowledge;
  knowledge.of_identification_ = true;
  const auto has = [&found](std::string_view name) {
    return std::any_of(found.begin(), found.end(), [&](const auto& one) { return one.name == name; });
  };
  double gain = 1.0;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& one = found[i];
    if (one.name == "amplifier.gain") gain = one.value;
    if (one.name == "motor.mass_kg") knowledge.model_mass_kg_ = one.value;
    if (one.name == "linkage.stiffness_N_per_m") knowledge.model_stiffness_N_per_m_ = one.value;
    const auto place = std::find_if(places().begin(), places().end(),
                                    [&](const Place& candidate) { return candidate.name == one.name; });
    if (place == places().end() || given.contains(place->key)) continue;
    if (one.name == "amplifier.lag_s" && has("amplifier.bandwidth_Hz")) continue;  // the same thing twice
    const auto [lower, upper] = one.interval_95;
    const auto in_scale = [&place](double value) {
      if (place->scale == Scale::linear) return value;
      return place->scale == Scale::odds ? std::log(value / (1.0 - value)) : std::log(value);
    };
    const double deviation = 0.5 * (in_scale(upper) - in_scale(lower)) / identification::normal_95;
    if (!std::isfinite(deviation)) continue;
    knowledge.add(*place, {.name = one.name, .unit = one.unit, .value = one.value, .interval_95 = one.interval_95},
                  deviation);
    rows.push_back(i);
  }
  knowledge.model_mass_kg_ /= gain;
  knowledge.model_stiffness_N_per_m_ /= gain;
  knowledge.set_correlation([&](std::size_t a, std::size_t b) {
    return correlation.empty() ? 0.0 : correlation[rows[a] * found.size() + rows[b]];
  });
  return knowledge;
}

Result<Knowledge> Knowledge::read(const std::filesystem::path& results, const Conditions& given) {
  using Json = nlohmann::ordered_json;
  std::ifstream stream(results, std::ios::binary);
  if (!stream) {
    return Error{ErrorCode::missing, {}, "the file cannot be read: check its permissions", results.string()};
  }
  const Json document = report::parse_json<Json>(std::string(std::istreambuf_iterator<char>(stream), {}));
  const auto refuse = [&results](std::string why) {
    return Error{ErrorCode::syntax, {}, std::move(why), results.string()};
  };
  const auto is_number = [](const Json& object, const char* key) {
    return object.contains(key) && object[key].is_number();
  };
  if (!document.is_object() || !document.contains("parameters") || !document["parameters"].is_array()) {
    return refuse("this is no result of tactus identify: identify again, or move the model away from it");
  }
  std::vector<identification::FoundParameter> found;
  for (const Json& one : document["parameters"]) {
    const bool whole = one.is_object() && one.contains("name") && one["name"].is_string() && is_number(one, "value") &&
                       one.contains("interval_95") && one["interval_95"].is_array() && one["interval_95"].size() == 2 &&
                       one["interval_95"][0].is_number() && one["interval_95"][1].is_number();
    if (!whole) return refuse("a parameter has no name, value or interval_95: identify again");
    found.push_back({.name = one["name"].get<std::string>(),
                     .unit = one.contains("unit") && one["unit"].is_string() ? one["unit"].get<std::string>() : "",
                     .value = one["value"].get<double>(),
                     .interval_95 = {one["interval_95"][0].get<double>(), one["interval_95"][1].get<double>()}});
  }
  std::vector<double> correlation;
  if (document.contains("correlation") && document["correlation"].is_array()) {
    for (const Json& row : document["correlation"]) {
      for (const Json& one : row) correlation.push_back(one.is_number() ? one.get<double>() : 0.0);
    }
    if (correlation.size() != found.size() * found.size()) {
      return refuse("correlation has not as many rows and columns as there are parameters: identify again");
    }
  }
  return identified(found, correlation, given);
}

Knowledge Knowledge::wrong_model(double share) {
  Knowledge knowledge;
  knowledge.stated_error_ = share;
  if (share == 0.0) return knowledge;
  for (const Place& place : places()) {
    if (place.scale != Scale::even) continue;
    knowledge.add(place, {.name = place.name, .unit = "", .value = 1.0, .interval_95 = {1.0 - share, 1.0 + share}},
                  share);
  }
  knowledge.set_correlation([](std::size_t, std::size_t) { return 0.0; });
  return knowledge;
}

Check Knowledge::fits(const control::MasterModel& model) const {
  const auto off = [](double one, double other) { return !(std::fabs(one - other) <= 0.01 * other); };
  if (!of_identification_) return {};
  if (model_mass_kg_ > 0.0 && off(model.motor.mass_kg, model_mass_kg_)) {
    return Error{ErrorCode::inconsistent,
                 "control.model.motor.mass_kg",
                 rounded_number(model.motor.mass_kg) +
                     " kg is not what the value in the results.json next to the model, " +
                     rounded_number(model_mass_kg_) + " kg: keep both files of one identification together",
                 {}};
  }
  if (model_stiffness_N_per_m_ > 0.0 && off(model.linkage.stiffness_N_per_m, model_stiffness_N_per_m_)) {
    return Error{ErrorCode::inconsistent,
                 "control.model.linkage.stiffness_N_per_m",
                 rounded_number(model.linkage.stiffness_N_per_m) +
                     " N/m is not what the value in the results.json next to the model, " +
                     rounded_number(model_stiffness_N_per_m_) + " N/m: keep both files of one identification together",
                 {}};
  }
  return {};
}

TappingParams Knowledge::drawn(const TappingParams& believed, std::uint64_t draw, const Known& known) const {
  TappingParams rig = believed;
  rig.task.supervised = false;
  signal::Random random = signal::Random(static_cast<std::uint64_t>(believed.task.seed)).fork(draw);
  // Larger than any that a person writes, so that no run has these taps.
  rig.task.seed = static_cast<std::int64_t>(random.bits() >> 1);
  const std::size_t size = parameters_.size();
  std::vector<double> normal(size), offset(size, 0.0);
  for (double& one : normal) one = draw == 0 || known.all ? 0.0 : random.normal();
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) offset[i] += root_[i * size + j] * normal[j];
  }
  if (known.one) {
    const std::size_t p = *known.one;
    const double variance = covariance_[p * size + p], shift = offset[p];
    for (std::size_t i = 0; i < size && variance > 0.0; ++i) offset[i] -= covariance_[i * size + p] / variance * shift;
    offset[p] = 0.0;
  }
  for (std::size_t i = 0; i < size; ++i) {
    const double middle = parameters_[i].value;
    double value = middle;
    switch (places_[i].scale) {
      case Scale::logarithm:
        value = middle * std::exp(offset[i]);
        break;
      case Scale::odds:
        value = 1.0 / (1.0 + (1.0 - middle) / middle * std::exp(-offset[i]));
        break;
      case Scale::linear:
        value = middle + offset[i];
        break;
      case Scale::even:
        value = middle + deviation_[i] * std::erf(offset[i] / deviation_[i] / std::numbers::sqrt2);
        break;
    }
    places_[i].put(rig, value);
  }
  return rig;
}

}  // namespace tactus::advice
