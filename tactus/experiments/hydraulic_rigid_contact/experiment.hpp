#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// A servo-hydraulic slave driven into its end stop through a sensorless loop (paper B, Fig. 8).
class HydraulicRigidContactExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "hydraulic-rigid-contact"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
