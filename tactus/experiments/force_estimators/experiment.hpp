#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// Estimators of contact force on the same data: one row for each.
class ForceEstimatorsExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "force-estimators"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
