// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/real_time/plant_segment.hpp>
#include <tactus/simulation/real_time/simulated_devices.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace tactus::real_time {

/// What a tap in real time runs through: both devices, and what happened at them that no sensor measures.
class TapPlant {
 public:
  virtual ~TapPlant() = default;
  virtual station::Device& master() noexcept = 0;
  virtual station::Device& slave() noexcept = 0;
  /// The next tick of the plant, after those that were given already, that has ended by this tick of the servo; none
  /// without one. Real-time safe.
  virtual std::optional<SimulatedTruth> next(const station::Tick& tick) noexcept = 0;
  /// Of the slave, true, after the ticks that were given. Real-time safe.
  [[nodiscard]] virtual double tip_position_m() const noexcept = 0;
  /// The plant cannot be continued. Real-time safe.
  [[nodiscard]] virtual bool lost() const noexcept = 0;
};

/// Both simulated devices of a tap: master and operator, slave and wall. A value.
class SimulatedPlant final : public TapPlant {
 public:
  /// At rest at the start of the tap. Errors: those of clock and plants.
  static Result<SimulatedPlant> make(const experiments::Tap& tap);

  SimulatedMaster& master() noexcept override { return master_; }
  SimulatedSlave& slave() noexcept override { return slave_; }
  /// Advances by one tick, under the commands that hold, while the plants are behind the tick.
  std::optional<SimulatedTruth> next(const station::Tick& tick) noexcept override;
  [[nodiscard]] double tip_position_m() const noexcept override { return slave_.plant().tip_position_m(); }
  [[nodiscard]] bool lost() const noexcept override { return false; }

  /// Ticks since the start.
  [[nodiscard]] std::int64_t ticks() const noexcept { return master_.ticks(); }
  /// Of the latest tick. Real-time safe.
  [[nodiscard]] SimulatedTruth truth() const noexcept;

 private:
  SimulatedPlant(const SimulatedMaster& master, const SimulatedSlave& slave) : master_(master), slave_(slave) {}

  SimulatedMaster master_;
  SimulatedSlave slave_;
};

/// All of an experiment that makes its plants what they are, as TOML: two experiments with equal text have equal plants
/// in every tap. The safety gates are part of it, for the devices keep to limits that follow from them. Controllers,
/// channel, number of taps and observation are not.
std::string plant_configuration(const experiments::TappingParams& params);

}  // namespace tactus::real_time
