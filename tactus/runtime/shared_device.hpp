#pragma once

#include <tactus/core/units.hpp>
#include <tactus/runtime/device.hpp>
#include <tactus/runtime/shared_slots.hpp>

#include <cstdint>

/// A device that another process owns: what the two processes tell each other in shared memory, and both sides of it.
namespace tactus::runtime {

/// Owner to controller.
struct SharedReading {
  DeviceReading reading;
  std::int64_t tick = 0;         ///< of the owner
  std::int64_t time_ns = 0;      ///< of CLOCK_MONOTONIC, when the owner's tick began
  std::uint64_t gave_up_on = 0;  ///< session whose commands the owner obeys no more; 0: none
};

/// Controller to owner.
struct SharedCommand {
  DeviceCommand command;
  std::int64_t time_ns = 0;   ///< of CLOCK_MONOTONIC, when the controller's tick began
  std::uint64_t session = 0;  ///< what it is a command of; see `DeviceServer::begin`
};

/// Where both meet. Memory of zeros is a valid, empty one.
struct DeviceSlots {
  SharedSlots<SharedReading, 8> readings;
  SharedSlots<SharedCommand, 8> commands;
};

/// The longest silence of the other process that a side puts up with, unless told otherwise.
inline constexpr Seconds usual_silence{0.02};
/// What a silence may be set to.
inline constexpr Bounds silence_bounds = between(0.001, 10.0);

/// The controller's side: the device as a servo thread sees it.
///
/// `good` with a reading that is newer than the last, `degraded` with none, and `lost` for the rest of the session once
/// the owner was silent for too long (or has another clock), told a number that is not finite, or obeys no more. Then
/// the reading stays the last good one. All but `limits` is wait-free and calls no system.
class SharedDevice final : public Device {
 public:
  /// On slots that outlive it. `silence` is how old a reading may be, by its time against that of the tick.
  SharedDevice(DeviceSlots& slots, const DeviceLimits& limits, Seconds silence) noexcept;

  /// From now on commands are of this session. Not while a servo thread reads.
  void begin(std::uint64_t session) noexcept;

  [[nodiscard]] DeviceLimits limits() const override { return limits_; }
  DeviceReading read(const Tick& tick) noexcept override;
  void write(const DeviceCommand& command) noexcept override;
  [[nodiscard]] DeviceHealth health() const noexcept override { return health_; }
  /// It is lost from now on: for what is found elsewhere.
  void lose() noexcept { health_ = DeviceHealth::lost; }
  /// Whether the owner was the one that gave up: the commands had come too late, or were not finite.
  [[nodiscard]] bool given_up_by_owner() const noexcept;

 private:
  DeviceSlots* slots_;
  DeviceLimits limits_;
  std::int64_t silence_ns_;
  std::uint64_t session_ = 0;
  std::int64_t now_ns_ = 0;
  SharedReading last_;
  DeviceHealth health_ = DeviceHealth::degraded;
};

/// The owner's side, a drive's watchdog included. Once a tick, in this order: `command` to the motor, `publish` what
/// the sensors read. Both are wait-free and call no system.
///
/// Commands are obeyed that belong to the session begun last. Once they have been silent for too long, or were not
/// finite, the motor gets no force for the rest of the session, and the controller is told: a force that comes back by
/// itself would surprise both the person and the controller.
class DeviceServer {
 public:
  /// On slots that outlive it. `silence` is how old a command may be, by its time against that of the tick.
  DeviceServer(DeviceSlots& slots, Seconds silence) noexcept;

  /// A session: the commands of one controller in one task. A number that was not used before in these slots.
  void begin(std::uint64_t session) noexcept;
  /// What the actuators may do from this tick on. Always finite; no force before the first command.
  DeviceCommand command(const Tick& tick) noexcept;
  /// `device_tick` is the reading's number, for who looks at it.
  void publish(const Tick& tick, std::int64_t device_tick, const DeviceReading& reading) noexcept;

  /// Commands of this session have come.
  [[nodiscard]] bool obeyed() const noexcept { return command_.session == session_ && session_ != 0; }
  /// The session lost its force.
  [[nodiscard]] bool gave_up() const noexcept { return gave_up_; }

 private:
  DeviceSlots* slots_;
  std::int64_t silence_ns_;
  std::uint64_t session_ = 0;
  SharedCommand command_;
  bool gave_up_ = false;
};

}  // namespace tactus::runtime
