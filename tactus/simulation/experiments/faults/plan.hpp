// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/teleoperator/fault_moment.hpp>
#include <tactus/simulation/teleoperator/fault_plan.hpp>

#include <cstdint>

/// Which faults the table tries. What a fault is, and what injects it, is the simulation's.
namespace tactus::experiments {

using simulation::FaultKind;
using simulation::FaultMoment;
using simulation::FaultPlan;
using simulation::FaultSite;

/// The plan number `index` of a kind: equal arguments, equal plan. Lengths are drawn evenly in their logarithm, a cut's
/// from 10 ms to `longest_cut_s`, a suspension's from 1 s, a stall's from 1 to 100 ms.
FaultPlan draw_plan(FaultKind kind, std::int64_t index, std::int64_t seed, double longest_cut_s);

}  // namespace tactus::experiments
