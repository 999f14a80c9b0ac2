// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace tactus::emulation {

/// What may be wrong with an emulated servo.
enum class ServoFault : std::int64_t {
  none,
  silence,         ///< it receives and does not reply
  power_cycle,     ///< it is off for 0.3 s, and restarts
  hot,             ///< it reports it, and takes its own torque away
  wrong_model,     ///< it is another one than its owner assumes
  low_limit,       ///< it was set to a tenth of its current
  twin,            ///< another servo has its id and answers behind it
  clash,           ///< another servo has its id and answers at the same time, so that no answer is whole
  error,           ///< its answers have an error byte that is not its own, and it continues
  ignores_disable  ///< it answers to what switches its torque off, and keeps it
};
constexpr auto enumerators(ServoFault) {
  return std::array{Enumerator{ServoFault::none, "none"},
                    Enumerator{ServoFault::silence, "silence"},
                    Enumerator{ServoFault::power_cycle, "power-cycle"},
                    Enumerator{ServoFault::hot, "hot"},
                    Enumerator{ServoFault::wrong_model, "wrong-model"},
                    Enumerator{ServoFault::low_limit, "low-limit"},
                    Enumerator{ServoFault::twin, "twin"},
                    Enumerator{ServoFault::clash, "clash"},
                    Enumerator{ServoFault::error, "error"},
                    Enumerator{ServoFault::ignores_disable, "ignores-disable"}};
}

/// What may be wrong with the line of emulated servos. Shares are those of all answers, drawn from a seed.
struct LineFaults {
  double corrupt = 0.0;   ///< a bit of the answer is wrong
  double garbage = 0.0;   ///< bytes that nobody sent are before it
  double split = 0.0;     ///< it comes in two pieces, 0.3 ms apart
  std::int64_t echo = 0;  ///< 1: what is sent comes back, as some adapters do
};

/// A fault as a user writes it.
struct WrittenFault {
  ServoFault servo = ServoFault::none;
  std::int64_t id = -1;      ///< of the servo; negative: of all
  std::int64_t from_ns = 0;  ///< after the first byte that the peer receives
  std::uint8_t error = 0;    ///< that `ServoFault::error` reports
  LineFaults line{};         ///< where it is one of the line
};
/// Reads `KIND[:ID][@SECONDS]`: an enumerator of `ServoFault`, of which servo and from when, as `hot:2@5`, `error` with
/// its byte, as `error=0x24:2@5`; or
/// `corrupt`, `garbage` and `split` for a hundredth of all answers, or `echo`. Errors: `syntax`, with the text and what
/// there is.
Result<WrittenFault> parse_servo_fault(std::string_view text);

/// Gives servos a fault while they run, in place of the one that they have: that of `fault.id`, or all. Its time counts
/// from now, or from the first byte that the peer receives (`began`). `id_of(servo)`: the id of one. Errors:
/// `inconsistent` for a fault of the line, and for wrong-model and low-limit, which a servo has from the start or
/// never.
template <class Servos, class IdOf>
Check inject_into(Servos& servos, const IdOf& id_of, const WrittenFault& fault, bool began, std::int64_t now_ns) {
  if (fault.servo == ServoFault::none || fault.servo == ServoFault::wrong_model ||
      fault.servo == ServoFault::low_limit) {
    return Error{ErrorCode::inconsistent, {}, "it cannot begin while the servos run: start them with it", {}};
  }
  for (auto& servo : servos) {
    if (fault.id >= 0 && fault.id != static_cast<std::int64_t>(id_of(servo))) continue;
    servo.fault = fault.servo;
    servo.fault_from_ns = fault.from_ns + (began ? now_ns : 0);
    servo.error = fault.error;
    servo.broke = false;
  }
  return std::nullopt;
}

}  // namespace tactus::emulation
