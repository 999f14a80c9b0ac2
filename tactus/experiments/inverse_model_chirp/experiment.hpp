#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// Force felt in free motion through an inverse model (paper B, Fig. 5).
class InverseModelChirpExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "inverse-model-chirp"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
