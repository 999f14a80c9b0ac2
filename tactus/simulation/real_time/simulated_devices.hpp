// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/simulation/teleoperator/site_plants.hpp>

#include <cstdint>

/// Devices that are simulated in real time, on the thread that reads them: before a reading the plant is advanced to
/// the tick, under the command that holds. So it continues while ticks are missed, as hardware does, and with none
/// missed it does bit for bit what it does in virtual time.
namespace tactus::real_time {

/// Where a hand means to be at a tick, and at the next.
struct Intent {
  double now_m = 0.0;
  double at_next_tick_m = 0.0;
};

/// Who follows a path, whatever happens.
class FollowsPath {
 public:
  FollowsPath(const mechanics::MinimumJerk& path, double tick_s) : path_(path), tick_s_(tick_s) {}
  /// Once a tick. Real-time safe.
  Intent step() noexcept {
    const double time_s = static_cast<double>(ticks_++) * tick_s_;
    return {.now_m = path_.position_m(time_s), .at_next_tick_m = path_.position_m(time_s + tick_s_)};
  }

 private:
  mechanics::MinimumJerk path_;
  double tick_s_;
  std::int64_t ticks_ = 0;
};

/// The master and the operator who holds it: `Person` has a `step` as `FollowsPath` has.
template <class Person>
class SimulatedMasterOf final : public station::Device {
 public:
  SimulatedMasterOf(const simulation::MasterPlant& plant, const simulation::Clock& clock, const Person& person,
                    const station::DeviceLimits& limits)
      : plant_(plant), clock_(clock), person_(person), limits_(limits) {}

  [[nodiscard]] station::DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  station::DeviceReading read(const station::Tick& tick) noexcept override {
    while (ticks_ < tick.number) advance();
    return plant_.read(tick);
  }
  void write(const station::DeviceCommand& command) noexcept override {
    plant_.write(command.enabled ? command : station::DeviceCommand{});
  }
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }

  /// Advances by one tick under the command that holds. Real-time safe.
  void advance() noexcept {
    const Intent intent = person_.step();
    plant_.begin_tick(intent.now_m, intent.at_next_tick_m);
    for (int i = 0; i < clock_.substeps; ++i) plant_.substep(i);
    ++ticks_;
  }
  /// Ticks since the start.
  [[nodiscard]] std::int64_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] Person& person() noexcept { return person_; }

 private:
  simulation::MasterPlant plant_;
  simulation::Clock clock_;
  Person person_;
  station::DeviceLimits limits_;
  std::int64_t ticks_ = 0;
};
using SimulatedMaster = SimulatedMasterOf<FollowsPath>;

/// The slave before its wall.
class SimulatedSlave final : public station::Device {
 public:
  SimulatedSlave(const simulation::SlavePlant& plant, const simulation::Clock& clock,
                 const station::DeviceLimits& limits)
      : plant_(plant), clock_(clock), limits_(limits) {}

  [[nodiscard]] station::DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  station::DeviceReading read(const station::Tick& tick) noexcept override;
  void write(const station::DeviceCommand& command) noexcept override {
    plant_.write(command.enabled ? command : station::DeviceCommand{});
  }
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }

  /// Advances by one tick under the command that holds. Real-time safe.
  void advance() noexcept;
  [[nodiscard]] std::int64_t ticks() const noexcept { return ticks_; }
  /// What no sensor measures: the contact in the tick that `advance` has advanced by, and where the tip is.
  [[nodiscard]] const simulation::SlavePlant& plant() const noexcept { return plant_; }

 private:
  simulation::SlavePlant plant_;
  simulation::Clock clock_;
  station::DeviceLimits limits_;
  std::int64_t ticks_ = 0;
};

}  // namespace tactus::real_time
