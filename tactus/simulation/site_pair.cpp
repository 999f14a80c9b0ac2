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

void SitePair::exchange_channels(SitePair& made) noexcept {
  made.to_slave_.continue_from(to_slave_);
  made.to_master_.continue_from(to_master_);
  std::swap(to_slave_, made.to_slave_);
  std::swap(to_master_, made.to_master_);
}

void SitePair::exchange_controllers(SitePair& made) noexcept {
  constexpr int ticks_to_rest = 1000;
  sites_.master.exchange_controller(made.sites_.master, master_input_, output_.master.motor_force_N, ticks_to_rest);
  sites_.slave.exchange_controller(made.sites_.slave, slave_input_, output_.slave.motor_force_N, ticks_to_rest);
}

}  // namespace tactus::simulation
