// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/faults/experiment.hpp>
#include <tactus/simulation/experiments/faults/presentation.hpp>
#include <tactus/simulation/experiments/faults/table.hpp>

#include <utility>

namespace tactus::experiments {

namespace {

/// The table of faults as an experiment: `task.kind = "faults"`.
class FaultExperiment final : public ExperimentOf<FaultsParams> {
  /// Errors besides those of every experiment: `inconsistent` for a varied key.
  Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

Result<Outcome> FaultExperiment::run(const Request& request, const Progress& progress) const {
  if (auto error = refuse_variations(request)) return *std::move(error);
  const auto params = request.document.read<FaultsParams>();
  if (!params) return params.error();
  const auto table = run_faults(*params, progress);
  if (!table) return request.document.locate(table.error());
  return present_faults(request, *params, *table, std::nullopt);
}

}  // namespace

std::unique_ptr<const Experiment> faults_experiment() { return std::make_unique<FaultExperiment>(); }

Check refuse_variations(const Request& request) {
  return refuse_variations(request, "the table of faults varies the faults only: use --set for a key");
}

Outcome present_faults(const Request& request, const FaultsParams& params, const FaultTable& table,
                       const std::optional<FaultsInRealTime>& real_time) {
  const auto shown = [](const FaultsParams& of) {
    return FaultsShown{
        .kind = "faults",
        .subject =
            "Two supervised sites, an operator who taps a stiff wall, and one fault in each run, drawn by its seed. A "
            "witness outside of the sites reads what reaches the motors and what was sent when.",
        .seeds = of.task.seeds,
        .rate_Hz = of.servo.rate_Hz,
        .rate_limit_N_per_s = of.control.gate.rate_limit_N_per_s,
        .configuration = configuration::to_toml(of)};
  };
  return present_faults(request, shown(params), table, real_time);
}

}  // namespace tactus::experiments
