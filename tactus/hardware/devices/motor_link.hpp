// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus.hpp>
#include <tactus/kernel/core/joints.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

namespace tactus::devices {

/// The process that switches off motors without a watchdog if this program stops.
enum class GuardState : std::int64_t {
  watches,  ///< or the motors need none
  gone,     ///< it has ended, or does not respond: no motor gets power
  acted     ///< it has switched the motors off, and no command has enabled nothing since
};

/// All motors of a bus after one of its cycles.
struct BusReadings {
  std::array<MotorReading, most_joints> motors{};
  BusState state = BusState::asking;
  std::int64_t cycles = 0;
  std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC, when the cycle ended
  std::int64_t unheard = 0;  ///< 1: commands were older than the silence allowed, so all motors lost their power
  GuardState guard = GuardState::watches;
};

/// What a tick wants of all motors.
struct BusCommands {
  std::array<MotorCommand, most_joints> motors{};
  std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC, of the tick
};

/// A motor that did not switch off as it was commanded to when its link ended.
struct PoweredMotor {
  std::size_t motor = 0;
  std::int64_t status = no_status;  ///< that it reported last
  bool off = false;                 ///< it reported in the end that it is off, later than `off_within_ns`
};
/// Of a motor at the end of its link; none where it reported in time that it is off.
constexpr std::optional<PoweredMotor> powered(std::size_t motor, const MotorReading& last) noexcept {
  if (last.off != 0 && last.fault != MotorFault::stays_on) return std::nullopt;
  return PoweredMotor{.motor = motor, .status = last.status, .off = last.off != 0};
}
/// For this long a link commands its motors at its end to switch off, where they do not report before that they are
/// off.
inline constexpr std::int64_t farewell_ns = 500'000'000;

/// Motors that are driven by a thread of their own, with which a servo tick exchanges newest values and never waits:
/// behind a port, or behind a service.
///
/// Commands that are older than the silence allowed take the power from all motors; it does not come back by itself:
/// commands that enable nothing must come first. When it is destroyed, or commanded to stop, the motors lose their
/// power before it ends: each is commanded to switch off until it has reported that it is off, for `farewell_ns` at
/// most.
class MotorLink {
 public:
  virtual ~MotorLink() = default;
  [[nodiscard]] virtual std::size_t motors() const noexcept = 0;
  /// One thread, the servo's. Wait-free.
  virtual void command(const BusCommands& commands) noexcept = 0;
  /// None before it began. Any thread. Wait-free.
  [[nodiscard]] virtual std::optional<BusReadings> newest() const noexcept = 0;
  /// False once it ended, by itself or because it was commanded to. Any thread. Wait-free.
  [[nodiscard]] virtual bool running() const noexcept = 0;

  /// Ends it; the motors lose their power first. Not real-time safe, as all that follows.
  virtual void stop() = 0;
  /// Waits until the motors were asked, so long at most; where that did not go well, it is stopped. Errors: what is
  /// wrong with them, or with the way to them.
  virtual Check wait_until_asked(Seconds longest) = 0;
  /// Once it is not running.
  [[nodiscard]] virtual MotorSheet sheet(std::size_t motor) const = 0;
  /// Once it was commanded to stop: the motors that may still have power, or that did not switch off when they were
  /// commanded to. Empty where the motors were never found to be what was stated: then none was given power.
  [[nodiscard]] virtual std::vector<PoweredMotor> powered_motors() const = 0;
  /// Why it ended by itself, or why its motors cannot be driven at present. Any thread.
  [[nodiscard]] virtual Check problem() const { return std::nullopt; }

 protected:
  /// Waits until `done` returns true, while the link runs, for `longest` at most. Not real-time safe.
  template <class Done>
  void wait_while_running(Seconds longest, const Done& done) const {
    using std::chrono::steady_clock;
    const auto until = steady_clock::now() + std::chrono::duration<double>(longest.value);
    while (running() && !done() && steady_clock::now() < until) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
};

/// Whether a tick's commands count: they are not older than the silence allowed, and have not been since a tick that
/// enabled nothing.
class CommandWatch {
 public:
  explicit CommandWatch(std::int64_t silence_ns) noexcept : silence_ns_(silence_ns) {}
  /// Real-time safe.
  bool trusts(const BusCommands& commands, std::int64_t now_ns) noexcept {
    bool nothing = true;
    for (const MotorCommand& command : commands.motors) nothing = nothing && command.enabled == 0;
    if (commands.time_ns > 0 && now_ns - commands.time_ns > silence_ns_) {
      silenced_ = true;
    } else if (nothing) {
      silenced_ = false;
    }
    return !silenced_;
  }
  /// Commands do not count until a cycle enables nothing. Real-time safe.
  void distrust() noexcept { silenced_ = true; }

 private:
  std::int64_t silence_ns_;
  bool silenced_ = false;
};

}  // namespace tactus::devices
