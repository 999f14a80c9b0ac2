// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/guarded_link.hpp>

namespace tactus::cli {

using devices::BusCommands;
using devices::BusReadings;
using devices::GuardState;

namespace {

bool wants_power(const BusCommands& commands) noexcept {
  for (const devices::MotorCommand& motor : commands.motors) {
    if (motor.enabled != 0) return true;
  }
  return false;
}

bool has_power(const BusReadings& readings) noexcept {
  for (const devices::MotorReading& motor : readings.motors) {
    if (motor.enabled != 0) return true;
  }
  return false;
}

}  // namespace

GuardState GuardedLink::state() const noexcept {
  if (guard_silent_ || page_->guard_ended.load(std::memory_order_relaxed) != 0) return GuardState::gone;
  const bool answered =
      page_->taken.load(std::memory_order_acquire) == page_->acknowledged.load(std::memory_order_relaxed);
  return answered ? GuardState::watches : GuardState::acted;
}

void GuardedLink::command(const BusCommands& commands) noexcept {
  const auto readings = link_->newest();
  const bool powered = readings && has_power(*readings);
  guard_silent_ = !guard_.alive(page_->guard_beats.load(std::memory_order_relaxed), commands.time_ns);
  const bool wanted = wants_power(commands);
  if (state() == GuardState::acted && !wanted && !powered) {
    page_->acknowledged.store(page_->taken.load(std::memory_order_acquire), std::memory_order_relaxed);
  }
  const bool allowed = state() == GuardState::watches;
  if (allowed || !wanted) {
    link_->command(commands);
  } else {
    BusCommands without_power;
    without_power.time_ns = commands.time_ns;
    link_->command(without_power);
  }
  page_->powered.store((allowed && wanted) || powered ? 1 : 0, std::memory_order_relaxed);
  if (!readings || readings->cycles == cycles_) return;
  cycles_ = readings->cycles;
  page_->program_beats.fetch_add(1, std::memory_order_release);
}

std::optional<BusReadings> GuardedLink::newest() const noexcept {
  auto readings = link_->newest();
  if (readings) readings->guard = state();
  return readings;
}

void GuardedLink::stop() {
  link_->stop();
  page_->powered.store(0, std::memory_order_relaxed);
}

}  // namespace tactus::cli
