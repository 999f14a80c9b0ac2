#pragma once

#include <tactus/simulation/experiment.hpp>

namespace tactus::simulation {

/// The table of faults as an experiment: `task.kind = "faults"`.
class FaultExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "faults"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  /// Errors besides those of every experiment: `inconsistent` for a varied key.
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::simulation
