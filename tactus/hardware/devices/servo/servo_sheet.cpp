// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/servo/servo_bus.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <string>

/// What a bus of servos tells a person.
namespace tactus::devices {

std::string servo_status_text(std::int64_t status) {
  if (status < 0) return "no status";
  const auto in_hex = [](std::uint8_t byte) {
    constexpr const char* digits = "0123456789abcdef";
    return std::string("0x") + digits[byte >> 4] + digits[byte & 0xf];
  };
  const ServoStatus parts = ServoStatus::of(status);
  std::string text = "error byte " + in_hex(parts.error);
  if (parts.condition != 0) text += ", error register " + in_hex(parts.condition);
  if (parts.power != 0) text += ", torque enable " + std::to_string(parts.power);
  return text;
}

Check ServoBus::problem() const {
  for (std::size_t i = 0; state_ == BusState::refused && i < count_; ++i) {
    if (Check found = problem(i)) return found;
  }
  return {};
}

MotorSheet ServoBus::sheet(std::size_t motor) const {
  const Servo& servo = servos_[motor];
  const double limit_A = static_cast<double>(servo.limit) * servo.model.current_unit_A;
  return {.model = servo.wrong == Wrong::model ? model_named(servo.found) : std::string(),
          .scales = servo.reading.answers == 0 ? std::string()
                    : limit_A > 0.0            ? rounded_number(limit_A) + " A"
                                               : "no force",
          .firmware = servo.firmware >= 0 ? std::to_string(servo.firmware) : std::string(),
          .torque_limit_Nm = limit_A * servo.model.torque_Nm_per_A,
          .problem = problem(motor)};
}

Check ServoBus::problem(std::size_t motor) const {
  const Servo& servo = servos_[motor];
  const std::string who = std::string("servo ") + std::to_string(servo.id);
  const std::string name = servo.model.name;
  switch (servo.wrong) {
    case Wrong::model: {
      const std::string other = model_named(servo.found);
      return Error{ErrorCode::inconsistent,
                   {},
                   who + " reports model number " + std::to_string(servo.found) +
                       (other.empty() ? std::string(", which is not known here,") : std::string(" (") + other + ")") +
                       " where " + name + " is stated: state the model that is there, or change the servo",
                   {}};
    }
    case Wrong::limit:
      return Error{ErrorCode::inconsistent,
                   {},
                   who + " has a current limit of " + std::to_string(servo.found) + ", where that of " + name +
                       " lies between 1 and " + std::to_string(servo.model.current_limit) +
                       ": state the model that is there, or set the limit (register " +
                       std::to_string(servo.found_at.address) + ")",
                   {}};
    case Wrong::refused:
      return Error{ErrorCode::failed,
                   {},
                   who + " refuses register " + std::to_string(servo.found_at.address) + " with error " +
                       std::to_string(servo.found) + ": switch its power off and on, and look at its firmware",
                   {}};
    case Wrong::twice:
      return Error{
          ErrorCode::inconsistent,
          {},
          who + " answers twice: two servos have this id: unplug one of them, and give the other one of its own",
          {}};
    case Wrong::garbled:
      return Error{ErrorCode::inconsistent,
                   {},
                   who +
                       " is answered for by bytes that are no packet: two servos have this id and talk at once, or "
                       "the line is disturbed: plug in one servo after the other, give each its own id, and look at "
                       "cable and ground",
                   {}};
    case Wrong::stays_on:
      return Error{ErrorCode::failed,
                   {},
                   who + " was commanded to switch off and does not report that it is off (" +
                       servo_status_text(servo.status.number()) +
                       "): switch off its supply, wait until it is at rest, and switch it on again",
                   {}};
    case Wrong::silent:
      break;
    case Wrong::nothing:
      return {};
  }
  return Error{ErrorCode::missing,
               {},
               who + " does not answer at " + std::to_string(bits_per_s_) +
                   " bit/s: look at its power, its cable, its id and its bit rate",
               {}};
}

}  // namespace tactus::devices
