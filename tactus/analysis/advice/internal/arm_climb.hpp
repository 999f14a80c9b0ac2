// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/arm_advise.hpp>
#include <tactus/analysis/advice/internal/arm_costs.hpp>

#include <cstddef>
#include <vector>

namespace tactus::advice {

/// A configuration with a gain at which its taps settle.
struct ArmStep {
  Method method;
  double gain = 0.0;
};

/// The search for what to try to the end: stages 2 and 3 of `advise`.
class ArmClimb {
 public:
  /// What it is given outlives it.
  ArmClimb(const ArmBench& bench, const ArmCosts& costs, const std::vector<Dimension>& dimensions,
           const experiments::Progress& progress)
      : bench_(bench), costs_(costs), dimensions_(dimensions), progress_(progress) {}

  /// Leaves in `steps` what it came to, the last the best; none where nothing settles. `progress` is told 0.1 to 0.6.
  /// Errors: those of reading the document.
  Check run();

  [[nodiscard]] const std::vector<ArmStep>& steps() const { return steps_; }
  [[nodiscard]] const std::vector<ArmChange>& changes() const { return changes_; }

 private:
  [[nodiscard]] Result<ArmTrial> trial_of(const Method& method) const;
  [[nodiscard]] std::vector<ArmScore> scores(const std::vector<Method>& methods, double gain,
                                             const std::vector<std::size_t>& failed, std::size_t most_failures) const;
  bool change(ArmStep& now, ArmScore& score);
  Result<bool> settle_all(ArmStep& now);
  Result<bool> look_about(const ArmStep& now);
  Check climb();
  Result<bool> mend();
  Check show_more(bool everywhere);

  const ArmBench& bench_;
  const ArmCosts& costs_;
  const std::vector<Dimension>& dimensions_;
  const experiments::Progress& progress_;
  std::vector<Situation> taps_;  ///< more as it looks about
  std::size_t round_ = 0;        ///< of changes
  std::vector<ArmStep> steps_;
  std::vector<ArmChange> changes_;
};

}  // namespace tactus::advice
