#include <tactus/runtime/local_loop.hpp>
#include <tactus/runtime/site_parts.hpp>

#include <utility>

namespace tactus::runtime {

using control::SiteRole;
using control::SiteState;

Result<LocalLoop> LocalLoop::make(const experiments::TappingParams& params, const Settings& settings,
                                  SiteExchange& exchange, SiteDevice master, SiteDevice slave) {
  if (auto error = validate(params)) return *std::move(error);
  const double tick_s = 1.0 / params.servo.rate_Hz;
  const auto books_of = [&](SiteRole role, const SiteDevice& device) {
    return SiteBooks(role, tick_s, force_step_limit_N(params, role, device.device->limits()));
  };
  const std::array books{books_of(SiteRole::master, master), books_of(SiteRole::slave, slave)};
  auto pair = station::LocalTeleoperator::make(control_of(params), params.channel, Seconds{tick_s}, 0.0, *master.device,
                                               *slave.device);
  if (!pair) return pair.error();
  const SiteConsole console({.duration_s = settings.duration_s,
                             .arm_at_once = settings.arm_at_once,
                             .listen_before_arming_s = params.control.supervision.watchdog.timeout_s,
                             .tick_s = tick_s},
                            exchange);
  return LocalLoop(console, books, std::move(master), std::move(slave), *std::move(pair));
}

bool LocalLoop::operator()(const station::Tick& tick) noexcept {
  if (console_.insisted()) {
    pair_.release();
    return false;
  }
  const control::SiteRequests pressed =
      console_.step(tick, books_[0].state(), pair_.sites().master().heard().session != 0);
  const auto done = pair_.step(tick, pressed);
  const std::array records{recorded(tick, pressed, pair_.sites().master(), done.master),
                           recorded(tick, pressed, pair_.sites().slave(), done.slave)};
  const std::uint64_t due_ns = streams_.time_ns(tick.deadline_ns);
  bool works = false, gives_force = false;
  for (std::size_t i = 0; i < records.size(); ++i) {
    books_[i].step(records[i], console_.time_s());
    if (streams_.site[i]) streams_.site[i]->push(due_ns, records[i]);
    works = works || (books_[i].state() != SiteState::configure && books_[i].state() != SiteState::fault);
    gives_force = gives_force || records[i].motor_force_N != 0.0 || records[i].handle_force_N != 0.0;
  }
  if (streams_.servo) streams_.servo->push(due_ns, recorded(tick));
  streams_.push(tick, console_.mark());
  if (master_.person != nullptr) master_.person->follow(books_[0].state() == SiteState::active);
  if (console_.ends_second()) end_second();
  return !console_.over(tick, works, gives_force);
}

void LocalLoop::end_second() noexcept {
  for (SiteBooks& books : books_) console_.exchange().seconds.try_push(books.end_second());
}

void LocalLoop::finish() noexcept {
  if (books_[0].in_a_second()) end_second();
}

}  // namespace tactus::runtime
