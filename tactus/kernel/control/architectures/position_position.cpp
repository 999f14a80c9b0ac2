// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/position_position.hpp>

namespace tactus::control {

namespace {

Result<Controllers> make_position_position(const ControlParams& params, Seconds dt) {
  const auto slave = PositionPositionSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  const auto master = PositionPositionMaster::make({.position_force = params, .coupling = params.slave}, dt);
  if (!master) return out_of("position_force", master.error());
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

}  // namespace

Architecture position_position_architecture() {
  return {.name = "position-position",
          .summary = "each device is pulled toward the other; no force sensor",
          .make = make_position_position,
          .uses_tip_force = false};
}

}  // namespace tactus::control
