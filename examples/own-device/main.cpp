// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/command.hpp>
#include <tactus/kernel/station/device_registry.hpp>

#include <memory>

#include "spring_carriage.hpp"

namespace {

using namespace tactus;

/// Where hardware is opened: ports, cards, whatever may fail.
Result<std::unique_ptr<station::Device>> open_carriage(control::SiteRole role, Seconds tick) {
  std::unique_ptr<station::Device> device =
      std::make_unique<SpringCarriage>(role == control::SiteRole::master, tick.value);
  return device;
}

}  // namespace

int main(int argc, char** argv) {
  station::register_device({"carriage", "a carriage on a rail", open_carriage});
  return cli::run_command(argc, argv);
}
