// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/kernel/control/supervision.hpp>
#include <tactus/simulation/experiments/faults/duty.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>
#include <tactus/simulation/experiments/faults/rows.hpp>

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

/// Which faults are tried on two arms, and what their sites owe to people then. Kinds, plans and duties are those of
/// one axis, where arms have them too.
namespace tactus::experiments {

/// The plan number `index` of a kind: equal arguments, equal plan. As that of one axis, but that sizes are an arm's, in
/// rad, a jump of an encoder is at least twice what `gate` takes for motion in a tick, no cut or restart lasts longer
/// than a second, and a wrong wire is so from the start in every other plan. `wired_s` is how long it is then looked
/// at.
FaultPlan draw_arm_plan(FaultKind kind, std::int64_t index, std::int64_t seed, const control::SafetyGate::Params& gate,
                        double rate_Hz, double wired_s);
/// Whether what a plan is about was there before anybody armed.
inline bool is_there_at_start(const FaultPlan& plan) { return plan.start_s == 0.0; }
/// Whether motors are tried and gravity compensation is judged: what is wrong is wired so, or in the model.
inline bool is_wired_so(const FaultPlan& plan) {
  return is_there_at_start(plan) && plan.kind != FaultKind::configurations_differ;
}
/// Whether a wrong model has too large lengths; else it has too large masses. By `size`.
inline bool is_of_lengths(const FaultPlan& plan) { return plan.choice % 2 == 1; }
/// The joint, from 0, that a plan is about, of so many.
std::size_t joint_of_plan(const FaultPlan& plan, std::size_t joints);

/// What must come of a plan: `duty_of`, and what arms' drives report besides.
FaultDuty arm_duty_of(const FaultPlan& plan, const control::SupervisionParams& supervision, double rate_Hz);

/// Every row, or the one with the id `only`; their rules are `arm_duty_of` and the bounds.
std::vector<FaultRow> arm_fault_rows(std::string_view only = {});

}  // namespace tactus::experiments
