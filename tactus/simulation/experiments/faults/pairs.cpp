// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/pairs.hpp>
#include <tactus/simulation/experiments/faults/schedule.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactus::experiments {

namespace {

/// What can strike beside another fault. A bad number brings the sites into states of its own, what is there from the
/// start leaves no session in which a second fault could strike, and what is only seen by a teleoperator that is made
/// for it is left to its own row.
constexpr std::array striking{FaultKind::loss_bursts,   FaultKind::disorder,      FaultKind::cut,
                              FaultKind::restart,       FaultKind::encoder_spike, FaultKind::encoder_freeze,
                              FaultKind::encoder_wrap,  FaultKind::force_dropout, FaultKind::force_bias,
                              FaultKind::stall,         FaultKind::overload,      FaultKind::stop_and_go,
                              FaultKind::suspend,       FaultKind::rate_drift,    FaultKind::delay_creeping,
                              FaultKind::peer_repeats,  FaultKind::peer_wrong,    FaultKind::hand_lets_go,
                              FaultKind::handle_clamped};

constexpr double longest_cut_s = 1.0;

FaultPlan strike(std::size_t which, const FaultPlan& plan, double start_s) {
  const FaultKind kind = striking[which % striking.size()];
  FaultPlan part = draw_plan(kind, plan.choice, plan.seed, longest_cut_s);
  part.start_s = start_s;
  return part;
}

}  // namespace

std::vector<FaultPlan> plans_of(const FaultPlan& plan) {
  signal::Random random = signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(13);
  if (plan.kind == FaultKind::two_faults) {
    constexpr std::size_t pairs = striking.size() * (striking.size() + 1) / 2;
    std::size_t second = static_cast<std::size_t>(plan.choice) % pairs, first = 0;
    // Row by row of the half of a square.
    while (second > first) second -= ++first;
    const double second_s = plan.start_s + random.uniform(0.0, 0.3);
    std::vector<FaultPlan> both{strike(first, plan, plan.start_s), strike(second, plan, second_s)};
    // A hand that let go stays away while anything else is wrong: pressing the switch again is no arming, and is
    // allowed.
    const double end_s = std::max(both[0].start_s + both[0].length_s, both[1].start_s + both[1].length_s);
    for (FaultPlan& part : both) {
      if (part.kind == FaultKind::hand_lets_go) part.length_s = end_s - part.start_s;
    }
    return both;
  }
  if (plan.kind == FaultKind::fault_while_arming) {
    using namespace fault_schedule;
    return {strike(static_cast<std::size_t>(plan.choice), plan, random.uniform(arm_s, press_s + button_s))};
  }
  return {plan};
}

}  // namespace tactus::experiments
