// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/control/supervised_site.hpp>

#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

namespace tactus::control {

namespace {

template <class Gated, class Payload>
void fill(SiteRecord& record, const Gated& site, const SupervisionOf<Payload>& supervision) noexcept {
  record.enabled = supervision.state() != SiteState::configure && (!supervision.lets_go() || site.passes_a_force());
  record.limit = static_cast<std::int64_t>(site.limit());
  record.fault = static_cast<std::int64_t>(site.fault());
  for_each_joint(
      [&record](const auto& gates) noexcept { record.given_J = farther(record.given_J, gates.motor().given_J()); },
      site.gates());
  if constexpr (has_joints<typename Gated::Sensors>) record.tare = static_cast<std::int64_t>(site.tare().state);
}

/// What the sensors read, with what is to be believed of the other site.
template <class Sensors>
Sensors with(Sensors sensors, const Each<Sensors, Arrival>& arrivals) noexcept {
  for_each_joint([](JointOf<Sensors>& joint, const Arrival& arrival) noexcept { joint.arrival = arrival; }, sensors,
                 arrivals);
  return sensors;
}

/// Whether motor and force sensor contradict one another, at any joint.
template <class Checks, class Gates, class Sensors>
bool contradict(Checks& checks, const Gates& gates, const Sensors& sensors, std::int64_t elapsed_ticks) noexcept {
  bool found = false;
  for_each_joint(
      [&](ForceSensorCheck& check, const JointOf<Gates>& joint, const JointOf<Sensors>& read) noexcept {
        const double tip_force_N = resisting_N(read);
        const bool contradicts = std::isfinite(tip_force_N) && check.step({.acted_N = joint.motor().passed_N(),
                                                                           .tip_force_N = tip_force_N,
                                                                           .elapsed_ticks = elapsed_ticks});
        found = found || contradicts;
      },
      checks, gates, sensors);
  return found;
}

/// The supervision of each joint. A motor that gives next to no force, as that of a leader which is only read, is not
/// tried: its sign can do no harm. No motor is tried with more than its gate lets through.
template <class Params>
auto supervision_of(const Params& params, SiteRole role) {
  auto all = member_of_each(params, &ControlParams::supervision);
  for_each_joint(
      [role](SupervisionParams& supervision, const ControlParams& joint) noexcept {
        constexpr double harmless_N = 1e-6;
        const SafetyGate::Params& gate = role == SiteRole::master ? joint.gate : joint.slave_gate;
        SignProbe::Params& probe = supervision.probe;
        if (probe.most_force_N > gate.force_limit_N) probe.most_force_N = std::max(gate.force_limit_N, probe.force_N);
        if (gate.force_limit_N < harmless_N) probe.force_N = probe.most_force_N = 0.0;
      },
      all, params);
  return all;
}

/// A gated site under the supervision that `settings` describe. `checked` says when its force sensor cannot be right.
template <template <class> class Supervised, class Gated, class Settings>
Result<Supervised<Gated>> supervise(Gated site, const Settings& settings, SiteRole role, std::int64_t session,
                                    Seconds dt, const Agreement& agreement,
                                    ForceSensorCheck::Params SupervisionParams::*checked, const char* group) {
  if (joints_of(settings) != joints_of(site.gates())) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "supervision",
                 .message = "is of " + std::to_string(joints_of(settings)) + " joints, and the site has " +
                            std::to_string(joints_of(site.gates())),
                 .place = {}};
  }
  const auto supervision = SupervisionOf<Each<Settings, Message>>::make(settings, role, session, dt, agreement);
  if (!supervision) return under("supervision", supervision.error());
  const auto check = make_each<ForceSensorCheck>(member_of_each(settings, checked), dt);
  if (!check) return under("supervision", under(group, check.error()));
  if constexpr (std::is_same_v<Supervised<Gated>, SupervisedMasterOf<Gated>>) {
    const auto gain = GainChange::make(joint_of(settings, 0).force_gain, site.force_gain(), dt);
    if (!gain) return under("supervision", under("force_gain", gain.error()));
    return Supervised<Gated>(std::move(site), *supervision, *check, *gain);
  } else {
    return Supervised<Gated>(std::move(site), *supervision, *check);
  }
}

/// What supervision judges the support of a device by.
template <class Raise, class Gated, class Sensors>
typename Raise::Snapshot snapshot_of(const Gated& site, const Sensors& sensors, std::int64_t elapsed_ticks) noexcept {
  typename Raise::Snapshot snapshot{.position_m = member_of_each(sensors, &JointOf<Sensors>::motor_position_m),
                                    .velocity_m_per_s = same_for_each(sensors, 0.0),
                                    .weight_N = site.weight_N(),
                                    .carried = site.is_carried(),
                                    .seen = true,
                                    .elapsed_ticks = elapsed_ticks};
  for_each_joint(
      [&snapshot](const JointOf<Sensors>& joint, double& velocity_m_per_s) noexcept {
        const double told = joint.motor_report.velocity_m_per_s;
        if (can_be_told(told)) velocity_m_per_s = told;
        snapshot.seen = snapshot.seen && std::isfinite(joint.motor_position_m);
      },
      sensors, snapshot.velocity_m_per_s);
  return snapshot;
}

/// Starts a tare that was asked for, once, as soon as the site has its device for itself, and ends one when it has not.
template <class Gated, class Payload>
void tare(Gated& site, const SupervisionOf<Payload>& supervision, bool asked, bool& tared) noexcept {
  const bool may = asked && supervision.may_tare();
  if (may && !tared) tared = site.begin_tare();
  if (tared && !may) site.stop_tare();
  tared = tared && asked;
}

/// The law that holds each joint while its support comes in, by its share.
template <class Payload>
Each<Payload, HoldingLaw> holding_law(const SupportRaiseOf<Payload>& support, double share,
                                      const Each<Payload, double>& at_m) noexcept {
  Each<Payload, HoldingLaw> laws = same_for_each(at_m, HoldingLaw{});
  if (share == 0.0) return laws;
  for_each_joint(
      [share](HoldingLaw& law, const SupportCheck& check, double position_m) noexcept {
        law = {.force_N = share * check.spring_N(position_m),
               .damping_N_s_per_m = share * check.params().damping_N_s_per_m};
      },
      laws, support.checks(), at_m);
  return laws;
}

}  // namespace

template <class Gated>
typename SupervisedMasterOf<Gated>::Output SupervisedMasterOf<Gated>::step(const Input& input) noexcept {
  supervision_.look(snapshot_of<SupportRaiseOf<Payload>>(site_, input.sensors, input.elapsed_ticks));
  const SiteState state = supervision_.decide(
      {.requests = input.requests,
       .elapsed_ticks = input.elapsed_ticks,
       .device_silent = input.device_silent,
       .fault = site_.fault(),
       .force_sensor = contradict(hand_sensor_, site_.gates(), input.sensors, input.elapsed_ticks)});
  if (supervision_.rearms()) {
    site_.rearm();
    for_each_joint([](ForceSensorCheck& check) noexcept { check.reset(); }, hand_sensor_);
  }
  if (supervision_.lets_go()) site_.release();
  if (const auto gain = gain_.step({.asked = input.requests.force_gain, .elapsed_ticks = input.elapsed_ticks})) {
    site_.set_force_gain(*gain);
  }
  if (input.requests.tare || tared_) tare(site_, supervision_, input.requests.tare, tared_);
  const bool follows = state == SiteState::active && !input.requests.clutch;
  if (state == SiteState::align || state == SiteState::armed) supervision_.stand_at_packet(offset_m_);

  const Sensors sensors = with(input.sensors, supervision_.arrival(offset_m_));
  const bool sinks = site_.is_carried() && !supervision_.carries();
  const auto here_m = member_of_each(sensors, &MasterInput::motor_position_m);
  const auto probe_N = supervision_.probe(here_m, site_.works(), sinks);
  const Shares shares{.force = supervision_.blend(follows),
                      .support = supervision_.carry(here_m),
                      .stops = !follows && !supervision_.probes()};
  const auto holds = holding_law(supervision_.support(), supervision_.hold(tared_), here_m);
  Output output{.site = site_.step(sensors, shares, input.elapsed_ticks, probe_N, holds),
                .packet = {},
                .record = supervision_.record()};
  Payload message = member_of_each(output.site, &MasterOutput::message);
  for_each_joint(
      [&](Message& told, double& told_m, double& offset_m) noexcept {
        if (follows || state == SiteState::configure) {
          told_m = told.position_m + offset_m;
        } else {
          offset_m = told_m - told.position_m;
          told.velocity_m_per_s = 0.0;  // of a position that stands
        }
        told.position_m = told_m;
        output.record.offset_m = farther(output.record.offset_m, offset_m);
      },
      message, told_m_, offset_m_);
  output.packet = supervision_.packet(message);
  fill(output.record, site_, supervision_);
  output.record.force_gain = gain_.gain();
  return output;
}

template <class Gated>
typename SupervisedSlaveOf<Gated>::Output SupervisedSlaveOf<Gated>::step(const Input& input) noexcept {
  supervision_.look(snapshot_of<SupportRaiseOf<Payload>>(site_, input.sensors, input.elapsed_ticks));
  const SiteState state = supervision_.decide(
      {.requests = input.requests,
       .elapsed_ticks = input.elapsed_ticks,
       .device_silent = input.device_silent,
       .fault = site_.fault(),
       .force_sensor = contradict(force_sensor_, site_.gates(), input.sensors, input.elapsed_ticks)});
  const auto here_m = member_of_each(input.sensors, &SlaveInput::motor_position_m);
  if (supervision_.rearms()) {
    site_.rearm();
    for_each_joint([](ForceSensorCheck& check) noexcept { check.reset(); }, force_sensor_);
    // A slave that was released in hold may be elsewhere than it was told to be.
    const bool was_released = supervision_.before() == SiteState::hold;
    if (state == SiteState::align || was_released) supervision_.stand(here_m);
  }
  // Nobody holds a tool, so it would coast.
  if (supervision_.contradicted()) {
    site_.brake();
  } else if (supervision_.lets_go()) {
    site_.release();
  }
  if (supervision_.probes()) supervision_.stand(here_m);
  if (input.requests.tare || tared_) tare(site_, supervision_, input.requests.tare, tared_);
  const Sensors sensors = with(input.sensors, supervision_.arrival(same_for_each(here_m, 0.0)));
  const bool sinks = site_.is_carried() && !supervision_.carries();
  const auto probe_N = supervision_.probe(here_m, site_.works(), sinks);
  const bool stands = state == SiteState::align || state == SiteState::armed;
  const bool works = stands || state == SiteState::active;
  const double support = supervision_.carry(here_m);
  const bool pulls = works && !supervision_.probes() && !supervision_.is_held();
  const Shares shares{.force = supervision_.blend(pulls), .support = support, .stops = !works};
  const auto holds = holding_law(supervision_.support(), supervision_.hold(tared_), here_m);
  Output output{.site = site_.step(sensors, shares, input.elapsed_ticks, probe_N, holds),
                .packet = {},
                .record = supervision_.record()};
  output.packet = supervision_.packet(member_of_each(output.site, &SlaveOutput::message));
  fill(output.record, site_, supervision_);
  return output;
}

template class SupervisedMasterOf<MasterSite>;
template class SupervisedMasterOf<JointMasterSite>;
template class SupervisedSlaveOf<SlaveSite>;
template class SupervisedSlaveOf<JointSlaveSite>;

namespace {

template <class Params>
auto supervised_master(const Params& params, std::int64_t session, Seconds dt, const Agreement& agreement)
    -> Result<SupervisedMasterOf<decltype(make_sites(params, dt)->master)>> {
  auto sites = make_sites(params, dt);
  if (!sites) return sites.error();
  return supervise<SupervisedMasterOf>(std::move(sites->master), supervision_of(params, SiteRole::master),
                                       SiteRole::master, session, dt, agreement, &SupervisionParams::hand_sensor,
                                       "hand_sensor");
}

template <class Params>
auto supervised_slave(const Params& params, std::int64_t session, Seconds dt, const Agreement& agreement)
    -> Result<SupervisedSlaveOf<decltype(make_sites(params, dt)->slave)>> {
  auto sites = make_sites(params, dt);
  if (!sites) return sites.error();
  return supervise<SupervisedSlaveOf>(std::move(sites->slave), supervision_of(params, SiteRole::slave), SiteRole::slave,
                                      session, dt, agreement, &SupervisionParams::force_sensor, "force_sensor");
}

}  // namespace

Result<JointSupervisedMaster> supervise_master(JointMasterSite site, const Joints<SupervisionParams>& params,
                                               std::int64_t session, Seconds dt, const Agreement& agreement) {
  return supervise<SupervisedMasterOf>(std::move(site), params, SiteRole::master, session, dt, agreement,
                                       &SupervisionParams::hand_sensor, "hand_sensor");
}
Result<JointSupervisedSlave> supervise_slave(JointSlaveSite site, const Joints<SupervisionParams>& params,
                                             std::int64_t session, Seconds dt, const Agreement& agreement) {
  return supervise<SupervisedSlaveOf>(std::move(site), params, SiteRole::slave, session, dt, agreement,
                                      &SupervisionParams::force_sensor, "force_sensor");
}

Result<SupervisedMaster> make_supervised_master(const ControlParams& params, std::int64_t session, Seconds dt) {
  return make_supervised_master(params, session, dt, agreement_of(params, dt));
}
Result<SupervisedMaster> make_supervised_master(const ControlParams& params, std::int64_t session, Seconds dt,
                                                const Agreement& agreement) {
  return supervised_master(params, session, dt, agreement);
}
Result<JointSupervisedMaster> make_supervised_master(const JointParams auto& params, std::int64_t session, Seconds dt,
                                                     const Agreement& agreement) {
  return supervised_master(params, session, dt, agreement);
}

Result<SupervisedSlave> make_supervised_slave(const ControlParams& params, std::int64_t session, Seconds dt) {
  return make_supervised_slave(params, session, dt, agreement_of(params, dt));
}
Result<SupervisedSlave> make_supervised_slave(const ControlParams& params, std::int64_t session, Seconds dt,
                                              const Agreement& agreement) {
  return supervised_slave(params, session, dt, agreement);
}
Result<JointSupervisedSlave> make_supervised_slave(const JointParams auto& params, std::int64_t session, Seconds dt,
                                                   const Agreement& agreement) {
  return supervised_slave(params, session, dt, agreement);
}

template Result<JointSupervisedMaster> make_supervised_master(const Joints<ControlParams>&, std::int64_t, Seconds,
                                                              const Agreement&);
template Result<JointSupervisedSlave> make_supervised_slave(const Joints<ControlParams>&, std::int64_t, Seconds,
                                                            const Agreement&);

}  // namespace tactus::control
