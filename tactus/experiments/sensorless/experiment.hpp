#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// Sources of the slave's force, cancellation and delay: one row for each combination, and one picture.
class SensorlessExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "sensorless"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  /// Besides the errors of every kind: `inconsistent` for a variation, for it varies by itself.
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
