// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/kernel/station/make_device_guard.hpp>

namespace tactus::station {

namespace {

/// That nobody drives a real device without supervision. Errors name the site.
Check refuse_unsupervised(bool supervised, bool master_is_real, bool slave_is_real) {
  if (supervised || (!master_is_real && !slave_is_real)) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = master_is_real ? "master" : "slave",
               .message =
                   "a device that is not simulated needs supervised sites, which an operator arms and can stop: "
                   "drive it by a LocalTeleoperator",
               .place = {}};
}

}  // namespace

template <class Pair>
Result<DevicePair<Pair>> DevicePair<Pair>::make(const Params& control, const LinkParams& channel, Seconds tick,
                                                const Lengths& slave_start_m, Device& master, Device& slave) {
  auto master_guard = make_device_guard(master, control, control::SiteRole::master);
  if (!master_guard) return master_guard.error();
  auto slave_guard = make_device_guard(slave, control, control::SiteRole::slave);
  if (!slave_guard) return slave_guard.error();
  if (Check error = refuse_unsupervised(supervised, *master_guard != nullptr, *slave_guard != nullptr)) return *error;
  const Params own = tightened(tightened(control, control::SiteRole::master, master.limits()), control::SiteRole::slave,
                               slave.limits());
  auto sites = Pair::make(own, channel, tick, slave_start_m);
  if (!sites) return sites.error();
  return DevicePair(*std::move(sites), {*std::move(master_guard), *std::move(slave_guard)}, slave_start_m, master,
                    slave);
}

template <class Pair>
Result<DevicePair<Pair>> DevicePair<Pair>::around(Pair sites, Device& master, Device& slave) {
  const auto joints = [&sites] {
    if constexpr (supervised) {
      return same_for_each(sites.slave().site().gates(), 0.0);
    } else {
      return same_for_each(sites.slave().gates(), 0.0);
    }
  }();
  auto master_guard = make_device_guard(master, joints_of(joints), control::SiteRole::master);
  if (!master_guard) return master_guard.error();
  auto slave_guard = make_device_guard(slave, joints_of(joints), control::SiteRole::slave);
  if (!slave_guard) return slave_guard.error();
  if (Check error = refuse_unsupervised(supervised, *master_guard != nullptr, *slave_guard != nullptr)) return *error;
  return DevicePair(std::move(sites), {*std::move(master_guard), *std::move(slave_guard)}, joints, master, slave);
}

template class DevicePair<SupervisedPair>;
template class DevicePair<BarePair>;
template class DevicePair<JointSupervisedPair>;
template class DevicePair<JointBarePair>;

}  // namespace tactus::station
