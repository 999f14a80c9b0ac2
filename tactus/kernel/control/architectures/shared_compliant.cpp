// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/shared_compliant.hpp>

namespace tactus::control {

namespace {

Result<Controllers> make_shared_compliant(const ControlParams& params, Seconds dt) {
  const auto master = PositionForceMaster::make(params, dt);
  if (!master) return master.error();
  const auto slave =
      SharedCompliantSlave::make({.slave = params.slave, .compliance = params.own<ComplianceParams>()}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

}  // namespace

Architecture shared_compliant_architecture() {
  return {.name = "shared-compliant",
          .summary = "position-force whose slave yields to the tip force by itself",
          .make = make_shared_compliant,
          .keys = own_keys<ComplianceParams>(
              "compliance", "Architecture shared-compliant: compliance of the slave's command to the tip force.")};
}

}  // namespace tactus::control
