#pragma once

#include <tactus/core/parameters.hpp>
#include <tactus/core/result.hpp>
#include <tactus/devices/motor_link.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// Buses and their motors as a person states them: in a rig file, or on a command line.
namespace tactus::devices {

/// A word for each kind of bus whose motors have a driver.
enum class BusKind : std::int64_t { damiao, dynamixel, feetech, inverse3 };
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
  std::string port;                     ///< of Haply's service HOST:PORT
  std::string device = {};              ///< which one of that service; empty: the first
  std::string framing = "usb2can";      ///< of CAN
  double patience_s = 0.002;            ///< of Damiao, for an answer; three times in a row make a motor silent
  double watchdog_s = 0.05;             ///< a motor that is unheard for so long is lost; of Damiao it lets go by itself
  std::int64_t bits_per_s = 1'000'000;  ///< of servos
  std::vector<StatedMotor> motors;
};

/// The words for models of a kind.
std::vector<std::string> models_of(BusKind kind);

/// Whether its motors let go by themselves when nobody speaks to them any more.
constexpr bool has_watchdog(BusKind kind) { return kind != BusKind::feetech; }

/// What a motor of this model can do, at its output.
struct MotorAbility {
  double torque_Nm = 0.0;           ///< 0: it takes no command; infinite: not known
  double velocity_rad_per_s = 0.0;  ///< that its numbers end at; 0: not known
  double position_rad = 0.0;        ///< to where a joint of it may have limits, either way from its zero
  /// The largest gains of the law that it runs by itself; both 0: it runs none.
  double stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0;
};
/// Of a motor that `check` passed.
MotorAbility ability_of(BusKind kind, const StatedMotor& motor);

/// The status of a motor as a person reads it, as `status 0x7 (unknown)`.
std::string status_text(BusKind kind, std::int64_t status);

/// That the statement is one, before anything is opened. Errors, with the remedy, under `framing`, `bits_per_s`,
/// `motors` or `motors[i].id`, `.model` and so on.
Check check(const StatedBus& stated);

/// Begins to drive it: opens the port, and asks. Errors: those of `check`; of the port, with its path as the place; no
/// thread.
Result<std::unique_ptr<MotorLink>> start(const StatedBus& stated);

/// The bit rates that servos of a kind can be set to; empty where the wire has its own.
std::vector<std::int64_t> bit_rates_of(BusKind kind);

}  // namespace tactus::devices
