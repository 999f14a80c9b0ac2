// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/internal/families.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>

#include <algorithm>

namespace tactus::experiments {

using namespace fault_families;

namespace {

simulation::Impairment draw_impairment(FaultKind kind, signal::Random& random) {
  simulation::Impairment impairment;
  if (kind == FaultKind::loss_bursts) {
    impairment.burst_begins_fraction = random.uniform(0.002, 0.05);
    impairment.burst_ends_fraction = random.uniform(0.01, 0.2);
    impairment.burst_loss_fraction = random.uniform(0.5, 1.0);
  } else if (kind == FaultKind::disorder) {
    impairment.delay_s = random.uniform(0.0, 0.02);
    impairment.jitter_s = random.uniform(0.0, 0.01);
    impairment.duplicate_fraction = random.uniform(0.0, 0.3);
  } else if (kind == FaultKind::delayed_wall) {
    impairment.delay_s = random.uniform(0.015, 0.03);
  } else if (kind == FaultKind::delay_asymmetric) {
    impairment.delay_s = between_logarithms(random, 0.03, 0.38);
  } else if (kind == FaultKind::delay_creeping) {
    impairment.delay_s = random.uniform(0.05, 0.5);
  }
  return impairment;
}

}  // namespace

FaultPlan draw_plan(FaultKind kind, std::int64_t index, std::int64_t seed, double longest_cut_s) {
  signal::Random random = signal::Random(static_cast<std::uint64_t>(seed))
                              .fork(static_cast<std::uint64_t>(kind))
                              .fork(static_cast<std::uint64_t>(index));
  FaultPlan plan;
  plan.kind = kind;
  plan.choice = index;
  plan.start_s = random.uniform(0.7, 1.7);
  plan.site = random.uniform() < 0.5 ? FaultSite::master : FaultSite::slave;
  plan.seed = static_cast<std::int64_t>(random.bits() >> 1);
  const double sign = random.uniform() < 0.5 ? -1.0 : 1.0;
  switch (kind) {
    case FaultKind::none:
      break;
    case FaultKind::loss_bursts:
    case FaultKind::disorder:
      plan.length_s = random.uniform(0.2, 1.5);
      break;
    case FaultKind::cut:
      plan.length_s = between_logarithms(random, 0.01, longest_cut_s);
      break;
    case FaultKind::suspend:
      plan.length_s = between_logarithms(random, std::min(1.0, longest_cut_s), longest_cut_s) + simulation::forgotten_s;
      plan.size = drive_timeout_s;
      break;
    case FaultKind::restart:
      plan.length_s = between_logarithms(random, 0.02, 1.0);
      break;
    case FaultKind::bad_number:
    case FaultKind::encoder_spike:
      plan.size = sign * between_logarithms(random, 0.005, 1.0);
      break;
    case FaultKind::encoder_wrap:
      plan.length_s = 0.5;
      plan.size = sign * 0.65536;  // 16 bits of 10 um
      break;
    case FaultKind::encoder_freeze:
      plan.length_s = 1.0;
      break;
    case FaultKind::force_dropout:
      plan.length_s = 1.0;
      break;
    case FaultKind::force_bias:
      plan.length_s = 1.0;
      plan.size = sign * between_logarithms(random, 0.2, 20.0);
      break;
    case FaultKind::stall:
      plan.length_s = between_logarithms(random, 0.001, 0.1);
      break;
    case FaultKind::delayed_wall:
      plan.length_s = 3.0;
      break;
    default:
      draw_device(plan, random, sign);
      draw_course(plan, random, sign);
  }
  plan.impairment = draw_impairment(kind, random);
  return plan;
}

}  // namespace tactus::experiments
