// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/wire/wire_end.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace tactus::emulation::damiao {

enum class FaultKind : std::int64_t {
  silence,       ///< receives nothing and reports nothing
  wrong_scale,   ///< VMAX half as large again as the type has; from the start
  over_voltage,  ///< these: a status that stays, whatever the motor receives
  under_voltage,
  over_current,
  hot_drive,
  hot_winding,
  communication_lost,
  overload,
  status,           ///< its feedback has a status that is not its own, which it continues by
  ignores_disable,  ///< it answers the order and keeps its power
  register_answer,  ///< among feedback, as if another program asked
  twin,             ///< another motor has its identifiers and answers too
  wrap,             ///< turns steadily beyond the end of its number; from the start
  garbage,          ///< of the adapter: bytes, or frames of nobody, between those of the motors
  heartbeat,        ///< of the adapter: notices every 10 ms
  bus_off,          ///< no frame passes
  power_cycle,      ///< it is off for 0.3 s, and wakes disabled, without the turns that it had counted; once
  split             ///< of the adapter: frames come in pieces
};
constexpr auto enumerators(FaultKind) {
  return std::array{Enumerator{FaultKind::silence, "silence"},
                    Enumerator{FaultKind::wrong_scale, "wrong-scale"},
                    Enumerator{FaultKind::over_voltage, "over-voltage"},
                    Enumerator{FaultKind::under_voltage, "under-voltage"},
                    Enumerator{FaultKind::over_current, "over-current"},
                    Enumerator{FaultKind::hot_drive, "hot-drive"},
                    Enumerator{FaultKind::hot_winding, "hot-winding"},
                    Enumerator{FaultKind::communication_lost, "communication-lost"},
                    Enumerator{FaultKind::overload, "overload"},
                    Enumerator{FaultKind::status, "status"},
                    Enumerator{FaultKind::ignores_disable, "ignores-disable"},
                    Enumerator{FaultKind::register_answer, "register-answer"},
                    Enumerator{FaultKind::twin, "twin"},
                    Enumerator{FaultKind::wrap, "wrap"},
                    Enumerator{FaultKind::garbage, "garbage"},
                    Enumerator{FaultKind::heartbeat, "heartbeat"},
                    Enumerator{FaultKind::bus_off, "bus-off"},
                    Enumerator{FaultKind::power_cycle, "power-cycle"},
                    Enumerator{FaultKind::split, "split"}};
}

struct Fault {
  FaultKind kind = FaultKind::silence;
  std::uint32_t motor = 0;   ///< its identifier; 0: all
  std::int64_t from_ns = 0;  ///< after the peer's first call
  std::int64_t until_ns = wire::never_ns;
  std::uint8_t status = 0;  ///< that `FaultKind::status` reports, 0 to 15

  /// A motor of this identifier; 0: the adapter.
  [[nodiscard]] bool concerns(std::uint32_t id) const noexcept { return motor == 0 || id == 0 || motor == id; }
  [[nodiscard]] bool lasts_at(std::int64_t since_start_ns) const noexcept {
    return since_start_ns >= from_ns && since_start_ns < until_ns;
  }
};

/// Reads `KIND[:MOTOR][@SECONDS][+SECONDS]`: of which motor, from when and how long, as `silence:2@5+0.1`; the kind
/// `status` with its number, as `status=0x7:2@5`. Errors: `syntax`, `out_of_bounds`.
Result<Fault> parse_fault(std::string_view text);

}  // namespace tactus::emulation::damiao
