#include <tactus/control/architecture.hpp>
#include <tactus/control/position_position.hpp>
#include <tactus/core/spelling.hpp>

#include <algorithm>
#include <vector>

namespace tactus::control {

namespace {

Result<Controllers> make_position_force(const ControlParams& params, Seconds dt) {
  const auto master = PositionForceMaster::make(params, dt);
  if (!master) return master.error();
  const auto slave = PositionForceSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

/// The error, its parameter taken out of `group`: what is a group of a site is no group of `ControlParams`.
Error out_of(std::string_view group, Error error) {
  if (error.parameter.starts_with(group)) error.parameter.erase(0, group.size());
  return error;
}

Result<Controllers> make_position_position(const ControlParams& params, Seconds dt) {
  const auto slave = PositionPositionSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  const auto master = PositionPositionMaster::make({.position_force = params, .coupling = params.slave}, dt);
  if (!master) return out_of("position_force.", master.error());
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

Result<Controllers> make_projection(const ControlParams& params, Seconds dt) {
  const auto master = ProjectionMaster::make({.position_force = params, .projection = params.projection}, dt);
  if (!master) return out_of("position_force.", master.error());
  const auto slave = PositionForceSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

Result<Controllers> make_shared_compliant(const ControlParams& params, Seconds dt) {
  const auto master = PositionForceMaster::make(params, dt);
  if (!master) return master.error();
  const auto slave = SharedCompliantSlave::make({.slave = params.slave, .compliance = params.compliance}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

Result<Controllers> make_four_channel(const ControlParams& params, Seconds dt) {
  const auto master = FourChannelMaster::make({.position_scale = params.position_scale,
                                               .force_gain = params.force_gain,
                                               .force_limit_N = params.force_limit_N,
                                               .four_channel = params.four_channel},
                                              dt);
  if (!master) return master.error();
  const auto slave = FourChannelSlave::make(
      {.force_gain = params.force_gain, .slave = params.slave, .four_channel = params.four_channel}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

Result<Controllers> make_four_channel_cancellation(const ControlParams& params, Seconds dt) {
  PositionForceMaster::Params plain = params;
  plain.cancellation = CancellationMode::off;
  const auto master = PositionForceMaster::make(plain, dt);
  if (!master) return master.error();
  const auto slave = CancellingSlave::make({.master = params, .slave = params.slave}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

Result<Controllers> make_wave_variables(const ControlParams& params, Seconds dt) {
  const auto master = WaveMaster::make({.position_scale = params.position_scale,
                                        .force_gain = params.force_gain,
                                        .force_limit_N = params.force_limit_N,
                                        .wave = params.wave},
                                       dt);
  if (!master) return master.error();
  const auto slave = WaveSlave::make({.slave = params.slave, .wave = params.wave}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

Result<Controllers> make_time_domain_passivity(const ControlParams& params, Seconds dt) {
  const auto master = PassivityMaster::make({.display = params, .passivity = params.passivity}, dt);
  if (!master) return out_of("display.", master.error());
  const auto slave = PassivitySlave::make({.slave = params.slave, .passivity = params.passivity}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

Result<Controllers> make_energy_tank(const ControlParams& params, Seconds dt) {
  const auto master = TankMaster::make({.display = params, .tank = params.tank}, dt);
  if (!master) return out_of("display.", master.error());
  const auto slave = TankSlave::make({.slave = params.slave, .tank = params.tank}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

std::vector<Architecture>& registry() {
  static std::vector<Architecture> all{
      {"position-force", "the slave follows the master's position, the master displays the slave's tip force",
       make_position_force},
      {"position-position", "each device is pulled toward the other; no force sensor", make_position_position, false},
      {"projection", "position-force that displays at once only what the hand holds", make_projection},
      {"shared-compliant", "position-force whose slave yields to the tip force by itself", make_shared_compliant},
      {"four-channel", "both sites tell the other position and force (Lawrence), with local force loops",
       make_four_channel},
      {"four-channel-cancellation",
       "position-force with cancellation as the slave's local force loop (paper A, appendix)",
       make_four_channel_cancellation},
      {"wave-variables", "the sites exchange wave variables: passive for every delay", make_wave_variables, false},
      {"time-domain-passivity", "position-force between two passivity observers and controllers",
       make_time_domain_passivity},
      {"energy-tank", "position-force, its forces paid from a tank of energy at each site", make_energy_tank},
  };
  return all;
}

Error unknown_architecture(const std::string& name) {
  std::vector<std::string_view> names;
  std::string list;
  for (const Architecture& architecture : registry()) {
    names.push_back(architecture.name);
    list += (list.empty() ? "" : ", ") + std::string(architecture.name);
  }
  const std::string_view meant = nearest_word(name, names);
  std::string message = "'";
  message += name + "' is no architecture: write one of " + list;
  if (!meant.empty()) message += "; did you mean '" + std::string(meant) + "'?";
  return {.code = ErrorCode::out_of_bounds, .parameter = "architecture", .message = message, .place = {}};
}

/// Puts the estimator that `params` ask for, if any, in place of the slave's force sensor.
Check estimate_slave_force(const ControlParams& params, const Architecture& architecture, Seconds dt,
                           Controllers& controllers) {
  if (params.slave_force.source == SlaveForceSource::sensor) return {};
  if (!architecture.uses_tip_force) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "slave_force.source",
                 .message = "the architecture " + std::string(architecture.name) +
                            " does not use the slave's tip force: leave the source at sensor, or choose another one",
                 .place = {}};
  }
  const auto force = SlaveForce::make(params.slave_force, dt);
  if (!force) return under("slave_force", force.error());
  controllers.slave = std::make_unique<EstimatingSlave>(*force, std::move(controllers.slave));
  return {};
}

}  // namespace

std::span<const Architecture> architectures() { return registry(); }

void register_architecture(const Architecture& architecture) {
  auto& all = registry();
  const auto same =
      std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == architecture.name; });
  if (same != all.end()) {
    *same = architecture;
  } else {
    all.push_back(architecture);
  }
}

Result<Sites> make_sites(const ControlParams& params, Seconds dt) {
  if (auto error = validate(params)) return *std::move(error);
  const auto& all = registry();
  const auto chosen =
      std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == params.architecture; });
  if (chosen == all.end()) return unknown_architecture(params.architecture);
  auto controllers = chosen->make(params, dt);
  if (!controllers) return controllers.error();
  if (auto error = estimate_slave_force(params, *chosen, dt, *controllers)) return *std::move(error);
  const auto gate = SafetyGate::make(params.gate, dt);
  if (!gate) return under("gate", gate.error());
  const auto handle_gate = ForceGate::make(params.handle_gate, dt);
  if (!handle_gate) return under("handle_gate", handle_gate.error());
  const auto slave_gate = SafetyGate::make(params.slave_gate, dt);
  if (!slave_gate) return under("slave_gate", slave_gate.error());
  return Sites{MasterSite(std::move(controllers->master), {*gate, *handle_gate}),
               SlaveSite(std::move(controllers->slave), *slave_gate)};
}

}  // namespace tactus::control
