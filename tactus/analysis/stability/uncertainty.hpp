// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/margins.hpp>
#include <tactus/simulation/experiments/model_mismatch.hpp>

/// What a wrong model of master and hand costs.
namespace tactus::stability {

/// The controller's model with its masses, its linkage's stiffness and its hand's damping each at 1 − share, 1 and
/// 1 + share of what the file states: 27 models. Between them nothing is tried.
struct UncertainLimit {
  /// Below it L stays within the unit circle for all models, 1 / max |L / μ|: no phase is trusted (small gain).
  double small_gain = 0.0;
  double small_gain_frequency_rad_per_s = 0.0;
  double smallest_limit = 0.0;       ///< of the gain limits of all models
  experiments::ModelMismatch worst;  ///< the model that has it
};

/// For `share` from 0 to 0.9. With cancellation off there is one model: none. Errors: those of `make_loop`.
Result<UncertainLimit> uncertain_limit(const simulation::Teleoperator::Params& params,
                                       const Linearisation& linearisation, double share);

}  // namespace tactus::stability
