#include <tactus/interfaces/cli/command.hpp>
#include <tactus/kernel/control/architecture.hpp>

#include <iostream>

#include "soft_limit_master.hpp"

namespace {

using namespace tactus;

/// `params` is the section [control] of the file, its bounds checked.
Result<control::Controllers> make_soft_limit(const control::ControlParams& params, Seconds dt) {
  const auto master = SoftLimitMaster::make({.site = params, .soft_limit = params.own<SoftLimitParams>()}, dt);
  if (!master) return master.error();
  const auto slave = control::PositionForceSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  return control::Controllers{control::master_controller(*master), control::slave_controller(*slave)};
}

}  // namespace

int main(int argc, char** argv) {
  const Check refused = control::register_architecture(
      {.name = "soft-limit",
       .summary = "position-force whose force bends into its limit",
       .make = make_soft_limit,
       .keys = control::own_keys<SoftLimitParams>("soft_limit", "Architecture soft-limit: where its bend begins."),
       .like_position_force = control::Likeness::about_rest});
  if (refused) {
    std::cerr << "my-tactus: " << describe(*refused) << '\n';
    return exit_status(*refused);
  }
  return cli::run_command(argc, argv);
}
