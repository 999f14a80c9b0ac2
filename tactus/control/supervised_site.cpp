#include <tactus/control/agreed_parameters.hpp>
#include <tactus/control/supervised_site.hpp>

#include <cmath>

namespace tactus::control {

namespace {

template <class Site>
void fill(SiteRecord& record, const Site& site, const Supervision& supervision) noexcept {
  record.enabled = supervision.state() != SiteState::configure && (!supervision.lets_go() || site.passes_a_force());
  record.limit = static_cast<std::int64_t>(site.limit());
  record.fault = static_cast<std::int64_t>(site.fault());
  record.given_J = site.gate().given_J();
}

}  // namespace

SupervisedMaster::Output SupervisedMaster::step(const Input& input) noexcept {
  const bool contradicts =
      std::isfinite(input.sensors.hand_force_N) && hand_sensor_.step({.acted_N = site_.gate().passed_N(),
                                                                      .tip_force_N = -input.sensors.hand_force_N,
                                                                      .elapsed_ticks = input.elapsed_ticks});
  const SiteState state = supervision_.decide({.requests = input.requests,
                                               .elapsed_ticks = input.elapsed_ticks,
                                               .fault = site_.fault(),
                                               .force_sensor = contradicts});
  if (supervision_.rearms()) {
    site_.rearm();
    hand_sensor_.reset();
  }
  if (supervision_.lets_go()) site_.let_go();
  const bool follows = state == SiteState::active && !input.requests.clutch;

  MasterInput sensors = input.sensors;
  sensors.arrival = supervision_.arrival(offset_m_);
  const double probe_N = supervision_.probe(sensors.motor_position_m, site_.passes_a_force());
  Output output{.site = site_.step(sensors, supervision_.blend(follows), input.elapsed_ticks, probe_N),
                .packet = {},
                .record = supervision_.record()};
  const double position_m = output.site.message.position_m;
  if (follows || state == SiteState::configure) {
    told_m_ = position_m + offset_m_;
  } else {
    offset_m_ = told_m_ - position_m;
  }
  Message message = output.site.message;
  message.position_m = told_m_;
  output.packet = supervision_.packet(message);
  fill(output.record, site_, supervision_);
  output.record.offset_m = offset_m_;
  return output;
}

SupervisedSlave::Output SupervisedSlave::step(const Input& input) noexcept {
  const bool finite = std::isfinite(input.sensors.tip_force_N);
  const bool implausible = finite && force_sensor_.step({.acted_N = site_.gate().passed_N(),
                                                         .tip_force_N = input.sensors.tip_force_N,
                                                         .elapsed_ticks = input.elapsed_ticks});
  const SiteState state = supervision_.decide({.requests = input.requests,
                                               .elapsed_ticks = input.elapsed_ticks,
                                               .fault = site_.fault(),
                                               .force_sensor = implausible});
  if (supervision_.rearms()) {
    site_.rearm();
    force_sensor_.reset();
    // A slave that was released in hold may be elsewhere than it was told to be.
    const bool was_released = supervision_.before() == SiteState::hold;
    if (state == SiteState::align || was_released) supervision_.stand(input.sensors.motor_position_m);
  }
  // Nobody holds a tool, so it would coast.
  if (supervision_.contradicted()) {
    site_.brake();
  } else if (supervision_.lets_go()) {
    site_.let_go();
  }
  if (supervision_.probes()) supervision_.stand(input.sensors.motor_position_m);
  SlaveInput sensors = input.sensors;
  sensors.arrival = supervision_.arrival(0.0);
  const double probe_N = supervision_.probe(sensors.motor_position_m, site_.passes_a_force());
  const bool stands = state == SiteState::align || state == SiteState::armed;
  const double share = supervision_.blend((stands || state == SiteState::active) && !supervision_.probes());
  Output output{
      .site = site_.step(sensors, share, input.elapsed_ticks, probe_N), .packet = {}, .record = supervision_.record()};
  output.packet = supervision_.packet(output.site.message);
  fill(output.record, site_, supervision_);
  return output;
}

Result<SupervisedMaster> make_supervised_master(const ControlParams& params, std::int64_t session, Seconds dt) {
  return make_supervised_master(params, session, dt, agreement_of(params, dt));
}

Result<SupervisedMaster> make_supervised_master(const ControlParams& params, std::int64_t session, Seconds dt,
                                                const Agreement& agreement) {
  auto sites = make_sites(params, dt);
  if (!sites) return sites.error();
  const auto supervision = Supervision::make(params.supervision, SiteRole::master, session, dt, agreement);
  if (!supervision) return under("supervision", supervision.error());
  const auto hand_sensor = ForceSensorCheck::make(params.supervision.hand_sensor, dt);
  if (!hand_sensor) return under("supervision.hand_sensor", hand_sensor.error());
  return SupervisedMaster(std::move(sites->master), *supervision, *hand_sensor);
}

Result<SupervisedSlave> make_supervised_slave(const ControlParams& params, std::int64_t session, Seconds dt) {
  return make_supervised_slave(params, session, dt, agreement_of(params, dt));
}

Result<SupervisedSlave> make_supervised_slave(const ControlParams& params, std::int64_t session, Seconds dt,
                                              const Agreement& agreement) {
  auto sites = make_sites(params, dt);
  if (!sites) return sites.error();
  const auto supervision = Supervision::make(params.supervision, SiteRole::slave, session, dt, agreement);
  if (!supervision) return under("supervision", supervision.error());
  const auto force_sensor = ForceSensorCheck::make(params.supervision.force_sensor, dt);
  if (!force_sensor) return under("supervision.force_sensor", force_sensor.error());
  return SupervisedSlave(std::move(sites->slave), *supervision, *force_sensor);
}

}  // namespace tactus::control
