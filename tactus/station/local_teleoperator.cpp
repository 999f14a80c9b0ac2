#include <tactus/station/local_teleoperator.hpp>
#include <tactus/station/wall.hpp>

namespace tactus::station {

template <class Pair>
Result<DevicePair<Pair>> DevicePair<Pair>::make(const Params& control, const LinkParams& channel, Seconds tick,
                                                const Lengths& slave_start_m, Device& master, Device& slave) {
  auto master_wall = wall_before(master, control, control::SiteRole::master);
  if (!master_wall) return master_wall.error();
  auto slave_wall = wall_before(slave, control, control::SiteRole::slave);
  if (!slave_wall) return slave_wall.error();
  if (!std::is_same_v<Wish, control::SiteRequests> && (*master_wall || *slave_wall)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = *master_wall ? "master" : "slave",
                 .message =
                     "a device that is not simulated needs supervised sites, which a person arms and can stop: "
                     "drive it by a LocalTeleoperator",
                 .place = {}};
  }
  const Params own = tightened(tightened(control, control::SiteRole::master, master.limits()), control::SiteRole::slave,
                               slave.limits());
  auto sites = Pair::make(own, channel, tick, slave_start_m);
  if (!sites) return sites.error();
  return DevicePair(*std::move(sites), {*std::move(master_wall), *std::move(slave_wall)}, slave_start_m, master, slave);
}

template class DevicePair<SupervisedPair>;
template class DevicePair<BarePair>;
template class DevicePair<JointSupervisedPair>;
template class DevicePair<JointBarePair>;

}  // namespace tactus::station
