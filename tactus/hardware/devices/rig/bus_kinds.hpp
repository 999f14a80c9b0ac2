// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/hardware/devices/plugin/driver_registry.hpp>
#include <tactus/hardware/wire/port.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// Buses and their motors as a user states them: in a rig file, or on a command line.
namespace tactus::devices {

/// A word for each kind of bus whose motors have a driver. `plugged` is any that was registered (`register_driver`): a
/// rig file names it by its own name.
enum class BusKind : std::int64_t { damiao, dynamixel, feetech, inverse3, plugged };
constexpr auto enumerators(BusKind) {
  return std::array{Enumerator{BusKind::damiao, "damiao"}, Enumerator{BusKind::dynamixel, "dynamixel"},
                    Enumerator{BusKind::feetech, "feetech"}, Enumerator{BusKind::inverse3, "inverse3"}};
}

struct StatedMotor {
  std::int64_t id = 0;
  std::string model;              ///< a word of its kind
  std::int64_t feedback_id = -1;  ///< of Damiao; -1: by convention `id` + 16
  double torque_Nm_per_A = 0.0;   ///< of a Feetech servo that takes a current
};

struct StatedBus {
  BusKind kind = BusKind::damiao;
  std::string port;                 ///< of Haply's service HOST:PORT
  std::string device = {};          ///< which one of that service; empty: the first
  std::string framing = "usb2can";  ///< of CAN
  double reply_timeout_s =
      0.002;  ///< of Damiao, for an answer; a motor that exceeds it three times in a row is not responding
  double watchdog_s = 0.05;  ///< a motor without a reply for so long is lost; of Damiao it releases its force by itself
  std::int64_t bits_per_s = 1'000'000;  ///< of servos
  std::vector<StatedMotor> motors;
  std::string driver = {};                              ///< name of the registered driver, where `kind` is `plugged`
  std::shared_ptr<const DriverSettings> settings = {};  ///< its own keys
};

/// The word after `bus =`.
std::string_view bus_name(const StatedBus& stated);

/// The words for models of a kind.
std::vector<std::string> models_of(BusKind kind);

/// Whether its motors remove their torque by themselves when commands stop. A plug-in promises it (`BlockingDriver`).
constexpr bool has_watchdog(BusKind kind) { return kind != BusKind::feetech; }

/// Of a motor of a bus that `check` passed.
MotorAbility ability_of(const StatedBus& bus, const StatedMotor& motor);

/// The status of a motor as a user reads it, as `status 0x7 (unknown)`.
std::string status_text(BusKind kind, std::int64_t status);

/// That the statement is one, before anything is opened. Errors, with the remedy, under `framing`, `bits_per_s`,
/// `motors` or `motors[i].id`, `.model` and so on.
Check check(const StatedBus& stated);

/// Opens the port of a bus that has one, which Haply's service does not. Errors: those of `check`; of the port, with
/// its path as the place.
Result<wire::Port> open_port(const StatedBus& stated);

/// Begins to drive it at a port that is open.
Result<std::unique_ptr<MotorLink>> start(const StatedBus& stated, wire::Port port);

/// Begins to drive it: opens the port, and asks. Errors: those of `check`; of the port, with its path as the place; no
/// thread.
Result<std::unique_ptr<MotorLink>> start(const StatedBus& stated);

/// The bit rates that servos of a kind can be set to; empty where the wire has its own.
std::vector<std::int64_t> bit_rates_of(BusKind kind);

}  // namespace tactus::devices
