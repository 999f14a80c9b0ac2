#include <tactus/simulation/site_pair.hpp>

namespace tactus::simulation {

Result<SitePair> SitePair::make(const control::ControlParams& control, const LinkParams& channel, Seconds tick,
                                double slave_start_m) {
  auto sites = control::make_sites(control, tick);
  if (!sites) return under("control", sites.error());
  auto to_slave = Channel::make(channel.to_slave, tick, {.position_m = slave_start_m});
  if (!to_slave) return under("channel.to_slave", to_slave.error());
  auto to_master = Channel::make(channel.to_master, tick, {.position_m = slave_start_m});
  if (!to_master) return under("channel.to_master", to_master.error());
  return SitePair(*std::move(sites), *std::move(to_slave), *std::move(to_master));
}

}  // namespace tactus::simulation
