// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/hydraulic_chirp/hydraulic_chirp.hpp>

#include <cmath>
#include <numbers>
#include <utility>

namespace tactus::experiments {

namespace {

constexpr double settling_s = 0.2;
constexpr double low_band_Hz = 2.0;
constexpr double papers_time_constant_s = 0.0018;

/// The chirp's frequency grows evenly.
double frequency_Hz(const HydraulicChirpTask& task, double time_s) {
  return task.start_frequency_Hz + (task.end_frequency_Hz - task.start_frequency_Hz) * time_s / task.duration_s;
}

double chirp_m(const HydraulicChirpTask& task, double time_s) {
  const double mean_Hz = 0.5 * (task.start_frequency_Hz + frequency_Hz(task, time_s));
  return task.amplitude_m * std::sin(2.0 * std::numbers::pi * mean_Hz * time_s);
}

Result<CurrentScore> score(std::string name, const control::InverseModelEstimator::Params& model,
                           const HydraulicChirpParams& params,
                           const std::vector<simulation::HydraulicRig::Sample>& run) {
  auto estimator = control::InverseModelEstimator::make(model, Seconds{1.0 / params.servo.rate_Hz});
  if (!estimator) return under("model", estimator.error());
  CurrentScore result{.name = std::move(name),
                      .blocks = model.prediction.blocks,
                      .time_constant_s = model.prediction.blocks > 0 ? model.prediction.block.time_constant_s : 0.0,
                      .estimate_mA = {}};
  std::size_t all = 0, low = 0;
  for (const simulation::HydraulicRig::Sample& sample : run) {
    const double felt_N = estimator->step({.command = sample.current_mA, .position = sample.position_m}).force;
    const double error_mA = felt_N / model.actuator_gain;
    result.estimate_mA.push_back(sample.current_mA + error_mA);
    if (sample.time_s < settling_s) continue;
    result.mae_mA += std::abs(error_mA);
    ++all;
    if (frequency_Hz(params.task, sample.time_s) >= low_band_Hz) continue;
    result.mae_below_2_Hz_mA += std::abs(error_mA);
    ++low;
  }
  result.mae_mA /= static_cast<double>(all);
  if (low > 0) result.mae_below_2_Hz_mA /= static_cast<double>(low);
  return result;
}

}  // namespace

Check check(const HydraulicChirpParams& params) {
  if (Check error = validate(params)) return error;
  const auto rig = simulation::HydraulicRig::make(params);
  if (!rig) return rig.error();
  return {};
}

Result<HydraulicChirpResult> run_hydraulic_chirp(const HydraulicChirpParams& params) {
  const auto rig = simulation::IdentifiedRig::make(params, params.task.training_amplitude_m);
  if (!rig) return rig.error();
  auto run = simulation::follow(
      params, [&](double time_s) { return chirp_m(params.task, time_s); }, params.task.duration_s);
  if (!run) return run.error();
  HydraulicChirpResult result{.fitted = rig->fitted(), .run = *std::move(run), .scores = {}};

  std::vector<std::pair<std::string, control::InverseModelEstimator::Params>> variants;
  for (const std::int64_t blocks : {0, 1, 2, 3}) {
    auto model = rig->with_blocks(blocks);
    if (!model) return model.error();
    variants.emplace_back(blocks == 0   ? "no prediction"
                          : blocks == 1 ? "1 block"
                                        : std::to_string(blocks) + " blocks",
                          *std::move(model));
  }
  control::InverseModelEstimator::Params papers = result.fitted.model;
  papers.prediction.blocks = 2;
  papers.prediction.block.time_constant_s = papers_time_constant_s;
  variants.emplace_back("2 blocks, the paper's Tp", papers);
  if (result.fitted.apparent_mass_kg > 0.0) {
    control::InverseModelEstimator::Params heavy = result.fitted.model;
    heavy.mass_kg = result.fitted.apparent_mass_kg;
    variants.emplace_back("no prediction, apparent mass", heavy);
  }
  for (auto& [name, model] : variants) {
    auto one = score(std::move(name), model, params, result.run);
    if (!one) return one.error();
    result.scores.push_back(*std::move(one));
  }
  return result;
}

}  // namespace tactus::experiments
