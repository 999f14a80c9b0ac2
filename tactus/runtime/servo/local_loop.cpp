// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/local_loop.hpp>
#include <tactus/runtime/servo/site_parts.hpp>

#include <utility>

namespace tactus::runtime {

using control::SiteRole;
using control::SiteState;

Result<LocalLoop> LocalLoop::make(const station::TeleoperatorParams& params, const Settings& settings,
                                  SiteExchange& exchange, SiteDevice master, SiteDevice slave) {
  if (auto error = validate(params)) return *std::move(error);
  const double tick_s = 1.0 / params.servo.rate_Hz;
  const auto counters_of = [&](SiteRole role, const SiteDevice& device) {
    return SiteCounters(role, tick_s, force_step_limit_N(params, role, device.device->limits()));
  };
  const std::array counters{counters_of(SiteRole::master, master), counters_of(SiteRole::slave, slave)};
  auto pair = station::LocalTeleoperator::make(params.control, params.channel, Seconds{tick_s}, 0.0, *master.device,
                                               *slave.device);
  if (!pair) return pair.error();
  const SiteConsole console({.duration_s = settings.duration_s,
                             .arm_at_once = settings.arm_at_once,
                             .listen_before_arming_s = params.control.supervision.watchdog.timeout_s,
                             .tick_s = tick_s},
                            exchange);
  return LocalLoop(console, counters, std::move(master), std::move(slave), *std::move(pair));
}

bool LocalLoop::operator()(const station::Tick& tick) noexcept {
  if (console_.insisted()) {
    pair_.release();
    return false;
  }
  const control::SiteRequests pressed =
      console_.step(tick, counters_[0].state(), pair_.sites().master().heard().session != 0);
  const auto done = pair_.step(tick, pressed);
  const std::array records{recorded(tick, pressed, pair_.sites().master(), done.master),
                           recorded(tick, pressed, pair_.sites().slave(), done.slave)};
  const std::uint64_t due_ns = streams_.time_ns(tick.deadline_ns);
  bool works = false, gives_force = false;
  for (std::size_t i = 0; i < records.size(); ++i) {
    counters_[i].step(records[i], console_.time_s());
    if (streams_.site[i]) streams_.site[i]->push(due_ns, records[i]);
    works = works || (counters_[i].state() != SiteState::configure && counters_[i].state() != SiteState::fault);
    gives_force = gives_force || records[i].motor_force_N != 0.0 || records[i].handle_force_N != 0.0;
  }
  if (streams_.servo) streams_.servo->push(due_ns, recorded(tick));
  streams_.push(tick, console_.mark(), console_.taken());
  if (master_.person != nullptr) master_.person->follow(counters_[0].state() == SiteState::active);
  if (console_.ends_second()) end_second();
  return !console_.over(tick, works, gives_force);
}

void LocalLoop::end_second() noexcept {
  for (SiteCounters& counters : counters_) console_.exchange().seconds.try_push(counters.end_second());
}

void LocalLoop::finish() noexcept {
  if (counters_[0].in_a_second()) end_second();
}

}  // namespace tactus::runtime
