#pragma once

#include <tactus/core/result.hpp>
#include <tactus/devices/motor_bus.hpp>
#include <tactus/wire/port.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tactus::cli {

/// A motor as the command line states it: `ID:MODEL`.
struct StatedMotor {
  std::int64_t id = 0;
  std::string model;
};

/// What a person says of a bus.
struct StatedBus {
  std::string kind;
  std::string port;
  std::vector<StatedMotor> motors;
  std::string framing;                  ///< of CAN
  std::int64_t bits_per_s = 1'000'000;  ///< of servos
};

/// What a motor said of itself, for a table.
struct MotorSheet {
  std::string scales;
  std::string firmware;
  Check problem;
};

/// A bus to be checked, with its port. `sheet` looks into the bus: not while a thread drives it.
struct BusToCheck {
  std::unique_ptr<devices::MotorBus> bus;
  wire::Port port;
  std::function<MotorSheet(std::size_t motor)> sheet;
};

/// A word for `--bus`.
struct BusKind {
  const char* name;
  Result<BusToCheck> (*make)(const StatedBus& stated);
};

Result<BusToCheck> make_damiao_bus(const StatedBus& stated);
Result<BusToCheck> make_dynamixel_bus(const StatedBus& stated);
Result<BusToCheck> make_feetech_bus(const StatedBus& stated);

/// The error for a word that is none of those.
Error unknown_word(const char* place, const std::string& word, const std::vector<std::string>& known);

}  // namespace tactus::cli
