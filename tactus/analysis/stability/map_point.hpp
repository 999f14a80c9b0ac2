// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/lane_run.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/experiments/model_mismatch.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <span>

/// One point of a stability map: a tap on the wall, as parameters, as numbers for the lanes, and as a verdict.
namespace tactus::stability {

/// The word that selects a map in a file.
enum class MapKind { stability_map };
constexpr auto enumerators(MapKind) { return std::array{Enumerator{MapKind::stability_map, "stability-map"}}; }

struct MapTask {
  MapKind kind = MapKind::stability_map;
  double speed_m_per_s = 0.06;
  double depth_m = 0.007;
  double observation_s = 1.0;
  double grip = 1.0;
  experiments::ModelMismatch mismatch;
  static constexpr auto fields() {
    return List{
        field("kind", &MapTask::kind, "What this file is for."),
        field("speed_m_per_s", &MapTask::speed_m_per_s, units::metre_per_second, between(0.001, 2.0),
              "Intended speed at the wall."),
        field("depth_m", &MapTask::depth_m, units::metre, between(1e-4, 0.1),
              "How far beyond the wall the operator aims."),
        field("observation_s", &MapTask::observation_s, units::second, between(0.15, 10.0),
              "How long the contact is observed from first touch, while the operator keeps pressing."),
        field("grip", &MapTask::grip, units::none, between(0.05, 20.0),
              "Stiffness and damping of the operator's grip over [operator.grip]; the controller does not know."),
        field("mismatch", &MapTask::mismatch, "Errors of the controller's model.")};
  }
};

struct MapParams : simulation::Teleoperator::Params {
  MapTask task;
  static constexpr auto fields() {
    return joined(simulation::Teleoperator::Params::fields(), List{field("task", &MapParams::task, "The tap.")});
  }
};

/// The teleoperator that the parameters mean, grip and errors of the model put in.
simulation::Teleoperator::Params teleoperator_params(const MapParams& params);

/// How long each run of a map lasts. Errors: those of `simulation::Clock`.
Result<LanePlan> make_plan(const MapParams& params);

/// The loop, ready to run. Errors: a value out of bounds; `inconsistent` for what the map's loop does not have: other
/// architectures than position-force, its rival stages, noise, jitter and loss, walls other than Kelvin-Voigt, the
/// Euler step, a grip that is estimated or changes.
Result<LanePoint> make_point(const MapParams& params);

/// How one contact went.
struct PointResult {
  experiments::Verdict verdict = experiments::Verdict::settled;
  double settling_time_s = 0.0;  ///< the whole observation where it did not settle
  double contacts = 0.0;
  double peak_force_N = 0.0;
  double residual_rms_N = 0.0;
};

/// Judges a run from its contact force at each tick. `settled`: within `experiments::settled_within_s`; `ringing`:
/// later; `limit-cycle`: not at all; `diverged`: it left the workspace, or never touched. The measure is that of the
/// tapping experiment (`experiments::judge_contact`).
PointResult judge(const LaneResult& run, std::span<const double> contact_force_N, double tick_s);

}  // namespace tactus::stability
