#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// Every method on the same rig: one row for each, and one picture.
class ContestExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "contest"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  /// Besides the errors of every kind: `inconsistent` for a variation, for the contest varies by itself.
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
