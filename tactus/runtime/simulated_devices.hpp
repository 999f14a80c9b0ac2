#pragma once

#include <tactus/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/site_plants.hpp>
#include <tactus/station/device.hpp>

#include <cstdint>

/// Devices that are simulated in real time, on the thread that reads them: before a reading the plant is advanced to
/// the tick, under the command that holds. So it goes on while ticks are missed, as hardware does, and with none missed
/// it does bit for bit what it does in virtual time.
namespace tactus::runtime {

/// The master and the person who holds it and follows a path.
class SimulatedMaster final : public station::Device {
 public:
  SimulatedMaster(const simulation::MasterPlant& plant, const simulation::Clock& clock,
                  const mechanics::MinimumJerk& path, const station::DeviceLimits& limits)
      : plant_(plant), clock_(clock), path_(path), limits_(limits) {}

  [[nodiscard]] station::DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  station::DeviceReading read(const station::Tick& tick) noexcept override;
  void write(const station::DeviceCommand& command) noexcept override {
    plant_.write(command.enabled ? command : station::DeviceCommand{});
  }
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }

  /// Advances by one tick under the command that holds. Real-time safe.
  void advance() noexcept;
  /// Ticks since the start.
  [[nodiscard]] std::int64_t ticks() const noexcept { return ticks_; }

 private:
  simulation::MasterPlant plant_;
  simulation::Clock clock_;
  mechanics::MinimumJerk path_;
  station::DeviceLimits limits_;
  std::int64_t ticks_ = 0;
};

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
  /// What no sensor tells: the contact in the tick that `advance` has advanced by, and where the tip is.
  [[nodiscard]] const simulation::SlavePlant& plant() const noexcept { return plant_; }

 private:
  simulation::SlavePlant plant_;
  simulation::Clock clock_;
  station::DeviceLimits limits_;
  std::int64_t ticks_ = 0;
};

}  // namespace tactus::runtime
