#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// Taps through the teleoperator: one row for each combination of the varied parameters (paper A, Fig. 13).
class TappingExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "tapping"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
