// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/device.hpp>

#include <cstdint>

/// A device of one's own, small enough to read: a carriage of 0.2 kg on a rail with 4 N s/m of damping. At the master a
/// hand, a spring of 60 N/m, leads it 15 mm to and fro; at the slave a wall, a spring of 500 N/m, begins at 5 mm. It is
/// computed in place of being measured; with an encoder card in `read` and an amplifier in `write` it would be real,
/// and `simulated` would go.
class SpringCarriage final : public tactus::station::Device {
 public:
  SpringCarriage(bool is_master, double tick_s) : is_master_(is_master), tick_s_(tick_s) {}

  /// What the drive can do, and what it is never asked for.
  [[nodiscard]] tactus::station::DeviceLimits limits() const override {
    return {.force_N = 4.0, .rate_N_per_s = 2000.0, .velocity_m_per_s = 2.0, .position_m = 0.08};
  }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] tactus::station::DeviceHealth health() const noexcept override {
    return tactus::station::DeviceHealth::good;
  }

  /// The carriage goes on to this tick under the command that holds, missed ticks included.
  tactus::station::DeviceReading read(const tactus::station::Tick& tick) noexcept override {
    for (; ticks_ < tick.number; ++ticks_) advance();
    return {.position_m = position_m_, .force_N = is_master_ ? hand_N() : wall_N()};
  }
  /// Without `enabled` the drive has no power.
  void write(const tactus::station::DeviceCommand& command) noexcept override {
    motor_N_ = command.enabled ? command.force_N : 0.0;
  }

 private:
  static constexpr double mass_kg = 0.2, damping_N_s_per_m = 4.0;
  static constexpr double hand_N_per_m = 60.0, wall_N_per_m = 500.0, wall_m = 0.005;

  /// Where the hand wants the handle: 15 mm out and back, each within a second.
  [[nodiscard]] double hand_m() const noexcept {
    const double seconds = static_cast<double>(ticks_) * tick_s_;
    const double phase = seconds - 2.0 * static_cast<double>(static_cast<std::int64_t>(seconds / 2.0));
    return 0.015 * (phase < 1.0 ? phase : 2.0 - phase);
  }
  [[nodiscard]] double hand_N() const noexcept { return hand_N_per_m * (hand_m() - position_m_); }
  [[nodiscard]] double wall_N() const noexcept {
    return position_m_ > wall_m ? wall_N_per_m * (position_m_ - wall_m) : 0.0;
  }
  void advance() noexcept {
    const double outside_N = is_master_ ? hand_N() : -wall_N();
    velocity_m_per_s_ += tick_s_ * (motor_N_ + outside_N - damping_N_s_per_m * velocity_m_per_s_) / mass_kg;
    position_m_ += tick_s_ * velocity_m_per_s_;
  }

  bool is_master_;
  double tick_s_;
  std::int64_t ticks_ = 0;
  double position_m_ = 0.0, velocity_m_per_s_ = 0.0, motor_N_ = 0.0;
};
