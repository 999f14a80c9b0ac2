// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/arm_teleoperator_params.hpp>

namespace tactus::station {

Check refuse_tare(const ArmTeleoperatorParams& params) {
  if (params.control.tare.cycles == 0) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "control.tare.cycles",
               .message = std::to_string(params.control.tare.cycles) +
                          ": tactus faults has no tare, only simulated taps and rigs have one; write 0",
               .place = {}};
}

Check refuse_tool_coupling(const ArmTeleoperatorParams& params, std::string_view what) {
  if (params.control.follower.coupling == arm_control::Coupling::joints) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "control.follower.coupling",
               .message = "tool: " + std::string(what) +
                          " knows arms alone that command one another joint by joint: look at taps in virtual time, "
                          "or write joints and take a leader that has the follower's joints",
               .place = {}};
}

}  // namespace tactus::station
