// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/uncertainty.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace tactus::stability {

Result<UncertainLimit> uncertain_limit(const simulation::Teleoperator::Params& params,
                                       const Linearisation& linearisation, double share) {
  if (const Bounds bounds = between(0.0, 0.9); !bounds.contain(share)) {
    return out_of_bounds("uncertainty", share, bounds, units::none);
  }
  const bool cancels = params.control.cancellation == control::CancellationMode::on;
  std::vector<double> factors{1.0};
  if (cancels && share > 0.0) factors = {1.0 - share, 1.0, 1.0 + share};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  UncertainLimit found{
      .small_gain = infinity, .small_gain_frequency_rad_per_s = 0.0, .smallest_limit = infinity, .worst = {}};
  for (const double mass : factors) {
    for (const double linkage : factors) {
      for (const double damping : factors) {
        const experiments::ModelMismatch mismatch{
            .mass = mass, .linkage_stiffness = linkage, .operator_damping = damping};
        simulation::Teleoperator::Params misjudged = params;
        misjudged.control.model = experiments::mismatched(params.control.model, mismatch);
        misjudged.control.force_gain = 1.0;
        const auto loop = make_loop(misjudged, linearisation);
        if (!loop) return loop.error();
        const LoopCurve curve = trace(*loop);
        for (std::size_t i = 0; i < curve.gain.size(); ++i) {
          if (1.0 / std::abs(curve.gain[i]) >= found.small_gain) continue;
          found.small_gain = 1.0 / std::abs(curve.gain[i]);
          found.small_gain_frequency_rad_per_s = curve.frequency_rad_per_s[i];
        }
        const double limit = stable_without_force(*loop) ? gain_margin(curve).factor : 0.0;
        if (limit >= found.smallest_limit) continue;
        found.smallest_limit = limit;
        found.worst = mismatch;
      }
    }
  }
  return found;
}

}  // namespace tactus::stability
