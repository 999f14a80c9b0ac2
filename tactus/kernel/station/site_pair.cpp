// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/station/site_pair.hpp>

#include <string>

namespace tactus::station {

namespace {

/// Both run on this computer, and are made together.
constexpr std::int64_t master_session = 1, slave_session = 2;

template <class Master, class Slave>
Result<std::pair<Master, Slave>> make_pair(const Each<typename Master::Sensors, control::ControlParams>& control,
                                           Seconds tick) {
  if constexpr (Supervised<Master>) {
    const control::Agreement agreement = control::agreement_of(control, tick);
    auto master = control::make_supervised_master(control, master_session, tick, agreement);
    if (!master) return master.error();
    auto slave = control::make_supervised_slave(control, slave_session, tick, agreement);
    if (!slave) return slave.error();
    return std::pair(*std::move(master), *std::move(slave));
  } else {
    auto sites = control::make_sites(control, tick);
    if (!sites) return sites.error();
    return std::pair(std::move(sites->master), std::move(sites->slave));
  }
}

/// What stands for having heard nothing yet, but that the slave is at `slave_start_m`.
template <class Payload, class Lengths>
Payload first_said(const Lengths& slave_start_m) {
  auto message = same_for_each(slave_start_m, control::Message{});
  for_each_joint([](control::Message& to, double start_m) { to.position_m = start_m; }, message, slave_start_m);
  if constexpr (std::is_same_v<Payload, decltype(message)>) {
    return message;
  } else {
    return {.message = message};
  }
}

}  // namespace

template <class Master, class Slave>
Result<SitePair<Master, Slave>> SitePair<Master, Slave>::make(const Params& control, const LinkParams& channel,
                                                              Seconds tick, const Lengths& slave_start_m) {
  if (joints_of(slave_start_m) != joints_of(control)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "slave_start_m",
                 .message = "is of " + std::to_string(joints_of(slave_start_m)) +
                            " joints, and the parameters are of " + std::to_string(joints_of(control)),
                 .place = {}};
  }
  auto sites = make_pair<Master, Slave>(control, tick);
  if (!sites) return under("control", sites.error());
  auto pair = around(std::move(sites->first), std::move(sites->second), channel, tick, slave_start_m);
  if (pair) pair->at_master_.message = first_said<Payload>(same_for_each(slave_start_m, 0.0));
  return pair;
}

template <class Master, class Slave>
Result<SitePair<Master, Slave>> SitePair<Master, Slave>::around(Master master, Slave slave, const LinkParams& channel,
                                                                Seconds tick, const Lengths& slave_start_m) {
  const auto first = first_said<Payload>(slave_start_m);
  auto to_slave = Transport::make(channel.to_slave, tick, first);
  if (!to_slave) return under("channel.to_slave", to_slave.error());
  auto to_master = Transport::make(channel.to_master, tick, first);
  if (!to_master) return under("channel.to_master", to_master.error());
  return SitePair(std::move(master), std::move(slave), *std::move(to_slave), *std::move(to_master), tick, first);
}

template Result<SupervisedPair> SitePair<control::SupervisedMaster, control::SupervisedSlave>::make(
    const control::ControlParams&, const LinkParams&, Seconds, const double&);
template Result<BarePair> SitePair<control::MasterSite, control::SlaveSite>::make(const control::ControlParams&,
                                                                                  const LinkParams&, Seconds,
                                                                                  const double&);
template Result<JointSupervisedPair> SitePair<control::JointSupervisedMaster, control::JointSupervisedSlave>::make(
    const Joints<control::ControlParams>&, const LinkParams&, Seconds, const Joints<double>&);
template Result<JointBarePair> SitePair<control::JointMasterSite, control::JointSlaveSite>::make(
    const Joints<control::ControlParams>&, const LinkParams&, Seconds, const Joints<double>&);
template Result<JointSupervisedPair> SitePair<control::JointSupervisedMaster, control::JointSupervisedSlave>::around(
    control::JointSupervisedMaster, control::JointSupervisedSlave, const LinkParams&, Seconds, const Joints<double>&);
template Result<JointBarePair> SitePair<control::JointMasterSite, control::JointSlaveSite>::around(
    control::JointMasterSite, control::JointSlaveSite, const LinkParams&, Seconds, const Joints<double>&);

}  // namespace tactus::station
