// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/make_device_guard.hpp>
#include <tactus/kernel/station/step.hpp>
#include <tactus/runtime/servo/site_loop.hpp>

#include <utility>

namespace tactus::runtime {

Result<SiteLoop> SiteLoop::make(const station::TeleoperatorParams& params, const Settings& settings,
                                SiteExchange& exchange, SiteDevice device) {
  if (auto error = validate(params)) return *std::move(error);
  const control::SiteRole role = settings.link.site;
  auto guard = station::make_device_guard(*device.device, params.control, role);
  if (!guard) return guard.error();
  auto endpoint = link::Endpoint::make(settings.link);
  if (!endpoint) return endpoint.error();
  const station::DeviceLimits limits = device.device->limits();
  auto site = make_supervised_site(params, role, limits, endpoint->session());
  if (!site) return site.error();
  const double tick_s = 1.0 / params.servo.rate_Hz;
  const control::SupervisionParams& supervision = params.control.supervision;
  const SiteConsole console({.duration_s = settings.duration_s,
                             .arm_at_once = settings.arm_at_once,
                             .listen_before_arming_s = supervision.watchdog.timeout_s,
                             .tick_s = tick_s},
                            exchange);
  return SiteLoop(console, SiteCounters(role, tick_s, force_step_limit_N(params, role, limits)), role,
                  SiteLink(*std::move(endpoint), supervision.packets.longest_age_s), *std::move(site),
                  std::move(device), *std::move(guard));
}

SiteLoop::SiteLoop(const SiteConsole& console, const SiteCounters& counters, control::SiteRole role, SiteLink link,
                   SupervisedSite site, SiteDevice device, std::unique_ptr<station::GuardedDevice> guard)
    : console_(console),
      counters_(counters),
      role_(role),
      link_(std::move(link)),
      site_(std::move(site)),
      device_(std::move(device)),
      guard_(std::move(guard)),
      driven_(guard_ ? guard_.get() : device_.device.get()) {}

bool SiteLoop::operator()(const station::Tick& tick) noexcept {
  if (console_.insisted()) {
    driven_->write({.enabled = false});
    return false;
  }
  const control::SiteRequests pressed = console_.step(tick, counters_.state(), link_.heard());
  SiteLogRecord record = std::visit(
      [&](auto& site) noexcept {
        SeenLink way{link_, [this](const station::Tick& now, const control::Packet& packet) noexcept {
                       if (streams_.packets == nullptr) return;
                       streams_.packets->push(streams_.time_ns(now.deadline_ns), recorded(now, packet));
                     }};
        const auto done = station::step(site, *driven_, way, tick, pressed);
        SiteLogRecord made = recorded(tick, pressed, site, done);
        made.arrivals = link_.arrivals();
        return made;
      },
      site_);
  record.round_trip_s = link_.condition().round_trip_s;
  record.link_silence_s = link_.condition().silence_s;
  counters_.step(record, console_.time_s());
  const control::SiteState state = counters_.state();
  if (device_.person != nullptr) device_.person->follow(state == control::SiteState::active);
  if (SiteStreams::Site* const stream = streams_.of(role_)) {
    stream->push(streams_.time_ns(tick.deadline_ns), record);
  }
  if (streams_.servo) streams_.servo->push(streams_.time_ns(tick.deadline_ns), recorded(tick));
  streams_.push(tick, console_.mark(), console_.taken());
  if (console_.ends_second()) end_second();
  const bool works = state != control::SiteState::configure && state != control::SiteState::fault;
  return !console_.over(tick, works, record.motor_force_N != 0.0 || record.handle_force_N != 0.0);
}

void SiteLoop::end_second() noexcept {
  const LinkSecond on_the_way = link_.end_second();
  SiteSecond second = counters_.end_second();
  second.round_trip_s = on_the_way.round_trip_s;
  second.age_s = on_the_way.age_s;
  second.loss_fraction = on_the_way.loss_fraction;
  console_.exchange().seconds.try_push(second);
  const auto& agreement =
      std::visit([](const auto& site) -> const control::AgreementCheck& { return site.agreement(); }, site_);
  link_.report_mismatch(agreement, console_.exchange());
}

void SiteLoop::finish() noexcept {
  if (counters_.in_a_second()) end_second();
}

}  // namespace tactus::runtime
