#include <tactus/cli/command.hpp>
#include <tactus/control/architecture.hpp>

#include "soft_limit_master.hpp"

namespace {

using namespace tactus;

/// `params` is the section [control] of the file, its bounds checked.
Result<control::Controllers> make_soft_limit(const control::ControlParams& params, Seconds dt) {
  const auto master = SoftLimitMaster::make({.site = params}, dt);
  if (!master) return master.error();
  const auto slave = control::PositionForceSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  return control::Controllers{control::master_controller(*master), control::slave_controller(*slave)};
}

}  // namespace

int main(int argc, char** argv) {
  control::register_architecture({"soft-limit", "position-force whose force bends into its limit", make_soft_limit});
  return cli::run_command(argc, argv);
}
