#include <tactus/station/site_pair.hpp>

namespace tactus::station {

namespace {

/// Both run on this computer, and are made together.
constexpr std::int64_t master_session = 1, slave_session = 2;

Result<std::pair<control::MasterSite, control::SlaveSite>> bare_sites(const control::ControlParams& control,
                                                                      Seconds tick) {
  auto sites = control::make_sites(control, tick);
  if (!sites) return sites.error();
  return std::pair(std::move(sites->master), std::move(sites->slave));
}

Result<std::pair<control::SupervisedMaster, control::SupervisedSlave>> supervised_sites(
    const control::ControlParams& control, Seconds tick) {
  auto master = control::make_supervised_master(control, master_session, tick);
  if (!master) return master.error();
  auto slave = control::make_supervised_slave(control, slave_session, tick);
  if (!slave) return slave.error();
  return std::pair(*std::move(master), *std::move(slave));
}

}  // namespace

template <class Master, class Slave>
Result<SitePair<Master, Slave>> SitePair<Master, Slave>::make(const control::ControlParams& control,
                                                              const LinkParams& channel, Seconds tick,
                                                              double slave_start_m) {
  auto sites = [&] {
    if constexpr (supervised) {
      return supervised_sites(control, tick);
    } else {
      return bare_sites(control, tick);
    }
  }();
  if (!sites) return under("control", sites.error());
  Payload first;
  if constexpr (supervised) {
    first.message.position_m = slave_start_m;
  } else {
    first.position_m = slave_start_m;
  }
  auto to_slave = Way::make(channel.to_slave, tick, first);
  if (!to_slave) return under("channel.to_slave", to_slave.error());
  auto to_master = Way::make(channel.to_master, tick, first);
  if (!to_master) return under("channel.to_master", to_master.error());
  return SitePair(std::move(sites->first), std::move(sites->second), *std::move(to_slave), *std::move(to_master), tick);
}

template Result<SupervisedPair> SitePair<control::SupervisedMaster, control::SupervisedSlave>::make(
    const control::ControlParams&, const LinkParams&, Seconds, double);
template Result<BarePair> SitePair<control::MasterSite, control::SlaveSite>::make(const control::ControlParams&,
                                                                                  const LinkParams&, Seconds, double);

}  // namespace tactus::station
