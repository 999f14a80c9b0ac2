// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/units.hpp>
#include <tactus/kernel/station/device_guard.hpp>
#include <tactus/runtime/servo/shared_slots.hpp>

#include <cstdint>

/// A device that another process owns: what the two processes exchange in shared memory, and both sides of it.
namespace tactus::runtime {

/// Owner to controller.
struct SharedReading {
  station::DeviceReading reading;
  std::int64_t tick = 0;         ///< of the owner
  std::int64_t time_ns = 0;      ///< of CLOCK_MONOTONIC, when the owner's tick began
  std::uint64_t gave_up_on = 0;  ///< session whose commands the owner obeys no more; 0: none
  station::ReleaseCause cause = station::ReleaseCause::none;  ///< why
};

/// Controller to owner.
struct SharedCommand {
  double force_N = 0.0;
  double handle_force_N = 0.0;
  std::uint64_t enabled = 0;
  std::int64_t tick = 0;      ///< of the controller; one that does not grow is no sign of life
  std::int64_t time_ns = 0;   ///< of CLOCK_MONOTONIC, when that tick began
  std::uint64_t session = 0;  ///< what it is a command of; see `DeviceServer::begin`
};

/// Where both meet. Memory of zeros is a valid, empty one.
struct DeviceSlots {
  SharedSlots<SharedReading, 8> readings;
  SharedSlots<SharedCommand, 8> commands;
};

/// The controller's side: the device as a servo thread sees it.
///
/// `good` with a reading that is newer than the last, `degraded` with none, and `lost` for the rest of the session once
/// the owner did not respond for too long (or has another clock), sent a number that is not finite, or obeys no more.
/// Then the reading stays the last good one. All but `limits` is wait-free and calls no system.
class SharedDevice final : public station::Device {
 public:
  /// On slots that outlive it. `silence` is how old a reading may be, by its time against that of the tick.
  SharedDevice(DeviceSlots& slots, const station::DeviceLimits& limits, Seconds silence,
               bool simulated = false) noexcept;

  /// From now on commands are of this session. Not while a servo thread reads.
  void begin(std::uint64_t session) noexcept;

  [[nodiscard]] station::DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }
  station::DeviceReading read(const station::Tick& tick) noexcept override;
  void write(const station::DeviceCommand& command) noexcept override;
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return health_; }
  /// It is lost from now on: for what is found elsewhere.
  void lose() noexcept { health_ = station::DeviceHealth::lost; }
  /// Whether the owner was the one that gave up.
  [[nodiscard]] bool given_up_by_owner() const noexcept;
  /// Why it did.
  [[nodiscard]] station::ReleaseCause owners_cause() const noexcept { return last_.cause; }

 private:
  DeviceSlots* slots_;
  station::DeviceLimits limits_;
  std::int64_t silence_ns_;
  bool simulated_;
  std::uint64_t session_ = 0;
  station::Tick now_;
  SharedReading last_;
  station::DeviceHealth health_ = station::DeviceHealth::degraded;
};

/// The owner's side, with a drive's watchdog and the device's own limits (`DeviceGuard`). Once a tick, in this order:
/// `command` to the motor, `publish` what the sensors read. Both are wait-free and call no system.
///
/// Commands are obeyed that belong to the session begun last, as far as the device's limits go. Once they have been
/// not responding for too long, or the guard has released its force, the motor's force ends for the rest of the
/// session, and the controller is informed: a force that comes back by itself would surprise both the operator and the
/// controller. A command whose tick does not grow is silence, whatever its time: so is one that something repeats which
/// does not control any more.
class DeviceServer {
 public:
  /// On slots that outlive it. `silence` is how old a command may be, by its time against that of the tick.
  DeviceServer(DeviceSlots& slots, Seconds silence, const station::DeviceLimits& limits = {}) noexcept;

  /// A session: the commands of one controller in one task. A number that was not used before in these slots. A force
  /// that is still there ends within its rate limit.
  void begin(std::uint64_t session) noexcept;
  /// What the actuators may do from this tick on. Always finite, within the limits; no force before the first command.
  station::DeviceCommand command(const station::Tick& tick) noexcept;
  /// `device_tick` is the reading's number, for who looks at it.
  void publish(const station::Tick& tick, std::int64_t device_tick, const station::DeviceReading& reading) noexcept;

  /// Commands of this session have come.
  [[nodiscard]] bool obeyed() const noexcept { return command_.session == session_ && session_ != 0; }
  /// The session lost its force.
  [[nodiscard]] bool gave_up() const noexcept { return guard_.cause() != station::ReleaseCause::none; }
  [[nodiscard]] const station::DeviceGuard& guard() const noexcept { return guard_; }

 private:
  DeviceSlots* slots_;
  std::int64_t silence_ns_;
  station::DeviceGuard guard_;
  std::uint64_t session_ = 0;
  SharedCommand command_;
  std::int64_t alive_ns_ = 0;  ///< time of the last command with a new tick
};

}  // namespace tactus::runtime
