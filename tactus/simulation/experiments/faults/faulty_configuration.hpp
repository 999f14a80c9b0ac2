// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architecture.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>

#include <array>
#include <cstddef>

namespace tactus::experiments {

/// What a site is made with: what the run states, or something else at the site of a plan that states it.
struct FaultyConfiguration {
  control::ControlParams control;
  Seconds tick;

  /// The keys in which sites can differ, one for each choice.
  static constexpr std::array keys{"control.architecture",       "servo.rate_Hz",
                                   "control.position_scale",     "control.force_limit_N",
                                   "control.gate.force_limit_N", "control.supervision.watchdog.timeout_s"};

  FaultyConfiguration(const control::ControlParams& params, Seconds dt, const FaultPlan& plan, FaultSite site)
      : control(params), tick(dt) {
    if (plan.kind != FaultKind::configurations_differ || plan.site != site) return;
    switch (static_cast<std::size_t>(plan.choice) % keys.size()) {
      case 0:
        control.architecture = control.architecture == "position-force" ? "position-position" : "position-force";
        break;
      case 1:
        tick.value *= 1.25;
        break;
      case 2:
        control.position_scale *= 1.5;
        break;
      case 3:
        control.force_limit_N *= 0.5;
        break;
      case 4:
        control.gate.force_limit_N *= 0.8;
        break;
      default:
        control.supervision.watchdog.timeout_s *= 3.0;
    }
  }
};

}  // namespace tactus::experiments
