// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/effort_limits.hpp>
#include <tactus/kernel/arm_control/site_tare.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactus::arm_control {

using control::TareState;

Result<SiteTare> SiteTare::make(Tare::Params params, const arm::Chain::Params& arm, const arm::Chain& model,
                                const Tare::Drives& drives, const JointVector& acting, Seconds dt) {
  constexpr std::int64_t usual_cycles = 2;
  if (params.cycles == 0) params.cycles = usual_cycles;
  const auto tare = Tare::make(params, model, drives, dt);
  if (!tare) return tare.error();
  return SiteTare(*tare, params.most_share * effort_limits(arm), acting);
}

void SiteTare::begin() noexcept {
  tare_.restart();
  comes_in_ = false;
  report_ = {.state = TareState::under_way};
}

void SiteTare::stop() noexcept {
  if (!moves()) return;
  report_ = {.state = TareState::stopped};
}

ArmCommand SiteTare::step(const ArmReading& reading) noexcept {
  ArmCommand command = tare_.step(reading);
  if (moves() && tare_.done()) judge();
  command.position.array() -= limit_share_ * tare_.away_rad();
  command.stiffness *= firmness();
  command.damping *= firmness();
  return command;
}

void SiteTare::judge() noexcept {
  constexpr double least_travel = 0.5;
  const JointVector found = tare_.lacking_N_m(), travel = tare_.travel();
  for (Eigen::Index i = 0; i < found.size(); ++i) {
    const bool moved = travel[i] >= least_travel;
    if (moved && std::fabs(found[i]) <= most_N_m_[i]) continue;
    report_ = {.state = moved ? TareState::too_large : TareState::still,
               .joint = static_cast<std::size_t>(i),
               .value = moved ? found[i] : travel[i]};
    return;
  }
  found_ = found;
  ticks_left_ = tare_.cycle_ticks();
  step_ = (found_ - acting_) / static_cast<double>(ticks_left_);
  comes_in_ = true;
}

const JointVector& SiteTare::lacking_N_m() noexcept {
  const double change = 1.0 / static_cast<double>(tare_.cycle_ticks());
  limit_share_ = moves() ? std::max(0.0, limit_share_ - change) : std::min(1.0, limit_share_ + change);
  if (!comes_in_) return acting_;
  acting_ += step_;
  if (--ticks_left_ == 0) {
    acting_ = found_;
    comes_in_ = false;
    report_ = {.state = TareState::done};
  }
  return acting_;
}

}  // namespace tactus::arm_control
