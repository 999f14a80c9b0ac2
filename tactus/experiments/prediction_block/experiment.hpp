#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// What prediction blocks do in frequency and in time (paper B, Fig. 3).
class PredictionBlockExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "prediction-block"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
