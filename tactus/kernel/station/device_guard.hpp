// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/kernel/station/device.hpp>

#include <array>
#include <cstdint>

/// The device guard: what a device allows, whoever commands it.
namespace tactus::station {

/// Why a device was given no more force.
enum class ReleaseCause : std::int64_t { none, timed_out, not_finite, force, rate, velocity, position };
constexpr auto enumerators(ReleaseCause) {
  return std::array{Enumerator{ReleaseCause::none, "none"},
                    Enumerator{ReleaseCause::timed_out, "timed-out"},
                    Enumerator{ReleaseCause::not_finite, "not-finite"},
                    Enumerator{ReleaseCause::force, "force"},
                    Enumerator{ReleaseCause::rate, "rate"},
                    Enumerator{ReleaseCause::velocity, "velocity"},
                    Enumerator{ReleaseCause::position, "position"}};
}
/// In words, as the rest of a sentence: `commands stopped coming`. For any number that was read somewhere.
const char* in_words(ReleaseCause cause);

/// The longest silence of the other process that a side puts up with, unless set otherwise.
inline constexpr Seconds usual_silence{0.02};
/// What a silence may be set to.
inline constexpr Bounds silence_bounds = between(0.001, 10.0);

/// What may reach a motor, from the limits of its device alone.
///
/// A command beyond `force_N` or faster than `rate_N_per_s` is held back to it; one that insists for longer than
/// `timeout` is no slip, and latches. An invalid number, and a device beyond `velocity_m_per_s` or `position_m`,
/// latch at once. From then on the force falls to zero, then the drive is switched off, and stays so until `rearm`. A
/// limit of 0: none, and without a rate limit the force falls at once.
///
/// Toward zero a force may always fall as fast as `force_N` over `control::longest_stop_s`, however slow the rate limit
/// is: the gates stop that fast.
///
/// The law of a drive counts with what it gives at the newest reading. What is held back is taken from force and law in
/// the same share, and a gain beyond its limit is held back too: to none, where the device states none. Once it has let
/// go a drive has no law.
///
/// It is behind `control::SafetyGate`, wherever the controller runs, and shares nothing with it but what both are
/// for: no limiter, no filter, no clock of ticks. Speed is distance over time since a mark that moves on every
/// `speed_window_ns`, so it takes an encoder's step for what it is, and finds a jump.
class DeviceGuard {
 public:
  DeviceGuard(const DeviceLimits& limits, Seconds timeout) noexcept;

  /// What the sensors read at a tick, and how old that is. Real-time safe, as is all below.
  void observe(double position_m, const Tick& tick, double age_s = 0.0, double velocity_m_per_s = 0.0) noexcept;
  /// What may reach the actuators from this tick on, always finite. Ticks that were missed earn no faster change.
  DeviceCommand pass(const DeviceCommand& wanted, const Tick& tick) noexcept;
  /// Latches, for what is found elsewhere. The first cause stays.
  void release(ReleaseCause cause) noexcept;
  /// Nothing is latched any more. The force continues from where it is.
  void rearm() noexcept;

  /// What was latched.
  [[nodiscard]] ReleaseCause cause() const noexcept { return cause_; }
  /// Calls of `pass` that held a command back, before anything was latched.
  [[nodiscard]] std::int64_t held_back() const noexcept { return held_back_; }

 private:
  static constexpr std::int64_t speed_window_ns = 5'000'000;

  DeviceLimits limits_;  ///< infinite without one
  std::int64_t timeout_ns_;
  ReleaseCause cause_ = ReleaseCause::none;
  [[nodiscard]] control::DriveLaw allowed(const control::DriveLaw& wanted) const noexcept;

  DeviceCommand passed_{.enabled = false};  ///< force: with that of the law
  double position_m_ = 0.0, velocity_m_per_s_ = 0.0;
  std::int64_t passed_ns_ = 0;
  bool passed_any_ = false;
  std::int64_t insisting_ns_ = 0;
  std::int64_t held_back_ = 0;
  bool marked_ = false;
  double mark_m_ = 0.0;
  std::int64_t mark_ns_ = 0;
};

/// That every limit is a number and none negative; of a device that is not simulated, that none is missing but that of
/// a second actuator. Errors: `out_of_bounds` or `missing`, with the limit's name, under the joint where there are
/// several.
template <class Reading>
Check check_limits(const DeviceOf<Reading>& device);

/// A device behind its guard, for the process whose servo thread drives it. `lost` once the wall has released its
/// force, of all joints where one was wrong. All but `limits` is real-time safe as far as the device is.
template <class Reading>
class GuardedDeviceOf final : public DeviceOf<Reading> {
 public:
  using Command = Each<Reading, DeviceCommand>;

  /// Around a device that outlives it, its limits checked.
  explicit GuardedDeviceOf(DeviceOf<Reading>& device, Seconds timeout = usual_silence)
      : device_(&device),
        guard_(guards_of(device.limits(), timeout)),
        timeout_ns_(std::int64_t(1e9 * timeout.value)),
        wanted_(same_for_each(guard_, DeviceCommand{.enabled = false})) {}

  [[nodiscard]] Each<Reading, DeviceLimits> limits() const override { return device_->limits(); }
  [[nodiscard]] bool simulated() const noexcept override { return device_->simulated(); }
  /// Releases as well where nothing was written for longer than `timeout`.
  Reading read(const Tick& tick) noexcept override;
  void write(const Command& command) noexcept override;
  [[nodiscard]] DeviceHealth health() const noexcept override {
    return cause() == ReleaseCause::none ? device_->health() : DeviceHealth::lost;
  }
  /// What was latched, at the first joint that has released its force.
  [[nodiscard]] ReleaseCause cause() const noexcept {
    ReleaseCause found = ReleaseCause::none;
    for_each_joint(
        [&found](const DeviceGuard& guard) noexcept {
          if (found == ReleaseCause::none) found = guard.cause();
        },
        guard_);
    return found;
  }
  /// Of each joint.
  [[nodiscard]] const Each<Reading, DeviceGuard>& guard() const noexcept { return guard_; }

 private:
  static Each<Reading, DeviceGuard> guards_of(const Each<Reading, DeviceLimits>& limits, Seconds timeout) {
    auto guards = same_for_each(limits, DeviceGuard(joint_of(limits, 0), timeout));
    for_each_joint(
        [timeout](DeviceGuard& guard, const DeviceLimits& joint) {
          guard = {joint, timeout};
        },
        guards, limits);
    return guards;
  }
  Command pass() noexcept;

  DeviceOf<Reading>* device_;
  Each<Reading, DeviceGuard> guard_;
  std::int64_t timeout_ns_;
  Tick now_;
  Command wanted_;
  std::int64_t written_ns_ = 0;
  bool written_ = false;  ///< ever
};
using GuardedDevice = GuardedDeviceOf<DeviceReading>;
using GuardedJointDevice = GuardedDeviceOf<Joints<DeviceReading>>;

}  // namespace tactus::station
