#pragma once

#include <tactus/experiments/experiment.hpp>

namespace tactus::experiments {

/// A force played to a moving hand: what cancellation leaves of the motion that it induces (paper A, Figs. 4 and 12).
class ForceDisplayExperiment final : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const override { return "force-display"; }
  [[nodiscard]] std::string schema() const override;
  [[nodiscard]] std::string reference() const override;
  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

}  // namespace tactus::experiments
