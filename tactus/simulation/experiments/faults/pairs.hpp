// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/faults/plan.hpp>

#include <vector>

namespace tactus::experiments {

/// The faults of one run: the plan itself, or those that it stands for. Two at once are drawn from all kinds, every
/// pair of them once before any comes again; one while arming begins between the buttons for arming and for
/// following.
std::vector<FaultPlan> plans_of(const FaultPlan& plan);

}  // namespace tactus::experiments
