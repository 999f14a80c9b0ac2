// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/safety_gate.hpp>

#include <algorithm>

namespace tactus::control {

namespace {

/// What of a force that pushes on may pass, `value` being how far it went: all up to the limit, none at the fault.
double share_beyond(double value, double limit) {
  return std::clamp((SafetyGate::fault_factor - value / limit) / (SafetyGate::fault_factor - 1.0), 0.0, 1.0);
}

/// Two measurements that are closer to one another are the same one, but for how exactly its age is known.
constexpr double least_ticks = 0.01;

}  // namespace

double SafetyGate::believe(double position_m, std::int64_t elapsed_ticks, std::optional<double> resisting_N,
                           double age_s, const DriveReport& tells) noexcept {
  elapsed_ticks_ = elapsed_ticks = std::max<std::int64_t>(elapsed_ticks, 1);
  const double acted_N = force_.passed_N();
  allowed_N_ = thermal_.step({.acted_N = acted_N, .peak_N = force_limit_N_, .elapsed_ticks = elapsed_ticks});
  if (!std::isfinite(position_m)) {
    latch(GateFault::not_finite);
    velocity_m_per_s_ = 0.0;
    return believed_m_;
  }
  const double net_N = acted_N - resisting_N.value_or(0.0);
  const double older_ticks = (age_s_ - age_s) / dt_s_;
  const double between_ticks = static_cast<double>(elapsed_ticks) + older_ticks;
  const EncoderFault wrong = encoder_.step({.position_m = position_m,
                                            .acted_N = acted_N,
                                            .unbalanced_N = resisting_N ? net_N : 0.0,
                                            .elapsed_ticks = elapsed_ticks,
                                            .older_ticks = older_ticks});
  age_s_ = age_s;
  if (wrong == EncoderFault::frozen) latch(GateFault::encoder_frozen);
  if (wrong == EncoderFault::jump) {
    latch(GateFault::encoder_jump);
    velocity_m_per_s_ = 0.0;
    return believed_m_;
  }
  believed_m_ = position_m;
  if (between_ticks > least_ticks) {
    velocity_m_per_s_ = derivative_.step_after(position_m, between_ticks);
    // What was found is not found again, so that its evidence stays.
    const bool found = fault() == GateFault::contradicted || fault() == GateFault::encoder_frozen;
    const MotionFault moved = found ? MotionFault::none
                                    : motion_.step({.position_m = position_m,
                                                    .tells = tells,
                                                    .acted_N = acted_N,
                                                    .force_limit_N = force_limit_N_,
                                                    .between_s = between_ticks * dt_s_});
    if (moved == MotionFault::contradicted) latch(GateFault::contradicted);
    if (moved == MotionFault::repeated) latch(GateFault::encoder_frozen);
  }
  damping_N_s_per_m_ = energy_.step({.acted_N = acted_N, .position_m = position_m, .elapsed_ticks = elapsed_ticks});
  if (std::fabs(position_m) >= fault_factor * position_limit_m_) latch(GateFault::workspace);
  if (std::fabs(velocity_m_per_s_) >= fault_factor * velocity_limit_m_per_s_) latch(GateFault::velocity);
  if (reversal_.step({.net_N = net_N, .velocity_m_per_s = velocity_m_per_s_, .elapsed_ticks = elapsed_ticks})) {
    latch(GateFault::reversed);
  }
  if (energy_.held()) latch(GateFault::energy);
  return believed_m_;
}

double SafetyGate::pass(double command_N, bool stops) noexcept {
  const bool finite = std::isfinite(command_N);
  if (!finite) latch(GateFault::not_finite);
  limit_ = ActiveLimit::none;
  double wanted_N = fault() == GateFault::none && !released_ ? command_N : 0.0;
  if (brakes_ && fault() == GateFault::none) wanted_N = brake_.step(velocity_m_per_s_);
  const bool damps =
      !released_ && damping_N_s_per_m_ > 0.0 && (fault() == GateFault::none || fault() == GateFault::energy);
  if (fault() == GateFault::none) {
    const double position_share = share_beyond(std::fabs(believed_m_), position_limit_m_);
    const double velocity_share = share_beyond(std::fabs(velocity_m_per_s_), velocity_limit_m_per_s_);
    if (velocity_share < 1.0 && wanted_N * velocity_m_per_s_ > 0.0) {
      wanted_N *= velocity_share;
      limit_ = ActiveLimit::velocity;
    }
    if (position_share < 1.0 && wanted_N * believed_m_ > 0.0) {
      wanted_N *= position_share;
      limit_ = ActiveLimit::workspace;
    }
  }
  if (damps) {
    wanted_N -= damping_N_s_per_m_ * velocity_m_per_s_;
    limit_ = ActiveLimit::energy;
  }
  if (std::fabs(wanted_N) > allowed_N_ && allowed_N_ < force_limit_N_) {
    wanted_N = std::copysign(allowed_N_, wanted_N);
    if (limit_ == ActiveLimit::none) limit_ = ActiveLimit::thermal;
  }
  const double passed_N = force_.step(wanted_N, stops || has_released(), elapsed_ticks_);
  if (limit_ == ActiveLimit::none) limit_ = force_.limit();
  return passed_N;
}

void SafetyGate::rearm() noexcept {
  force_.rearm();
  encoder_.reset();
  motion_.reset();
  energy_.reset();
  reversal_.reset();
  brake_.reset();
  derivative_.reset();
  believed_m_ = age_s_ = 0.0;
  velocity_m_per_s_ = 0.0;
  damping_N_s_per_m_ = 0.0;
  released_ = brakes_ = false;
  fault_ = GateFault::none;
  limit_ = ActiveLimit::none;
}

}  // namespace tactus::control
