// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/bench_knowledge.hpp>

#include <functional>
#include <string>
#include <vector>

/// Successive isolation: a master identified from the motor outward, one element after the other (paper A, Sec. VII-B).
namespace tactus::identification {

/// How long and how hard the bench is excited. Forces scale with nothing: they are for a master of about paper A's
/// size.
struct IsolationParams {
  double sweep_s = 2.0;             ///< each swept sine but the held one
  double held_sweep_s = 60.0;       ///< with the operator, down to 0.1 Hz
  double full_force_N = 1.0;        ///< the largest that teleoperation will display
  double full_deflection_m = 2e-3;  ///< to which the model for cancellation lets it move the hand
  BenchParams start;                ///< where the fits start: a data sheet, or a guess
};

/// One stage: what was run, and what came of it.
struct IsolationStage {
  std::string title;  ///< `cable, drum locked`
  std::vector<BenchExperiment> experiments;
  std::vector<std::vector<double>> modelled_m;  ///< positions that the model gives for them, after the stage
  double residual_rms_m = 0.0;                  ///< of measured less modelled position
};

struct Isolation {
  std::vector<FoundParameter> parameters;
  std::vector<double> correlation;  ///< matrix of `parameters`, row by row (`BenchKnowledge::correlation`)
  std::vector<IsolationStage> stages;
  BenchParams found;
};

/// Receives each step of work: what is being done, and the share that is done already, from 0 to 1.
using IsolationProgress = std::function<void(const std::string& what, double done)>;

/// Runs the whole recipe. Errors: those of the rig, and `inconsistent` where a stage's data do not determine its
/// parameters. Not real-time safe.
Result<Isolation> isolate(Rig& rig, const IsolationParams& params, const IsolationProgress& progress);

}  // namespace tactus::identification
