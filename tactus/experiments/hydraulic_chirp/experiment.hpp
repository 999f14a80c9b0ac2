#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// The current of a servo-hydraulic slave's valve, measured and as an inverse model says it (paper B, Fig. 7).
class HydraulicChirpExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "hydraulic-chirp"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
