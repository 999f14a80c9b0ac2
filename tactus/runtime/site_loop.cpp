#include <tactus/runtime/site_loop.hpp>
#include <tactus/station/step.hpp>
#include <tactus/station/wall.hpp>

#include <algorithm>
#include <utility>

namespace tactus::runtime {

Result<SiteLoop> SiteLoop::make(const experiments::TappingParams& params, const Settings& settings,
                                SiteExchange& exchange, SiteDevice device) {
  if (auto error = validate(params)) return *std::move(error);
  const control::SiteRole role = settings.link.site;
  auto wall = station::wall_before(*device.device, params.control, role);
  if (!wall) return wall.error();
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
  return SiteLoop(console, SiteBooks(role, tick_s, force_step_limit_N(params, role, limits)), role,
                  *std::move(endpoint), *std::move(site), std::move(device), *std::move(wall),
                  supervision.packets.longest_age_s);
}

SiteLoop::SiteLoop(const SiteConsole& console, const SiteBooks& books, control::SiteRole role, link::Endpoint endpoint,
                   SupervisedSite site, SiteDevice device, std::unique_ptr<station::GuardedDevice> wall,
                   double longest_age_s)
    : console_(console),
      books_(books),
      role_(role),
      endpoint_(std::move(endpoint)),
      site_(std::move(site)),
      device_(std::move(device)),
      wall_(std::move(wall)),
      driven_(wall_ ? wall_.get() : device_.device.get()),
      longest_age_s_(longest_age_s) {}

/// The way of the site: the link, and the books of what came on it.
struct SiteLoop::LinkWay {
  SiteLoop& loop;
  std::int64_t arrivals = 0;
  template <class Take>
  void receive(const station::Tick& tick, Take&& take) noexcept {
    const auto packets = loop.endpoint_.receive(tick.began_ns);
    arrivals = static_cast<std::int64_t>(packets.size());
    loop.condition_ = loop.endpoint_.condition(tick.began_ns);
    SiteStreams::Packets* const stream = loop.streams_.packets.get();
    for (const control::Packet& packet : packets) {
      loop.count(packet, take(packet));
      if (stream != nullptr) stream->push(loop.streams_.time_ns(tick.deadline_ns), recorded(tick, packet));
    }
  }
  void send(const control::Packet& packet, const station::Tick& tick) noexcept {
    loop.endpoint_.send(packet, tick.began_ns);
  }
};

bool SiteLoop::operator()(const station::Tick& tick) noexcept {
  if (console_.insisted()) {
    driven_->write({.enabled = false});
    return false;
  }
  const control::SiteRequests pressed = console_.step(tick, books_.state(), newest_.session != 0);
  SiteLogRecord record = std::visit(
      [&](auto& site) noexcept {
        LinkWay way{*this};
        const auto done = station::step(site, *driven_, way, tick, pressed);
        SiteLogRecord made = recorded(tick, pressed, site, done);
        made.arrivals = way.arrivals;
        return made;
      },
      site_);
  record.round_trip_s = condition_.round_trip_s;
  record.link_silence_s = condition_.silence_s;
  books_.step(record, console_.time_s());
  const control::SiteState state = books_.state();
  if (device_.person != nullptr) device_.person->follow(state == control::SiteState::active);
  if (SiteStreams::Site* const stream = streams_.of(role_)) {
    stream->push(streams_.time_ns(tick.deadline_ns), record);
  }
  if (streams_.servo) streams_.servo->push(streams_.time_ns(tick.deadline_ns), recorded(tick));
  if (console_.ends_second()) end_second();
  const bool works = state != control::SiteState::configure && state != control::SiteState::fault;
  return !console_.over(tick, works, record.motor_force_N != 0.0 || record.handle_force_N != 0.0);
}

void SiteLoop::count(const control::Packet& packet, control::PacketVerdict verdict) noexcept {
  ++link_totals_.packets[verdict];
  if (verdict != control::PacketVerdict::applied) return;
  const bool older = packet.session == newest_.session && packet.sequence <= newest_.sequence;
  if (older || packet.age_s > longest_age_s_) ++link_totals_.stale_applied;
  newest_ = packet;
  for (Arrivals* sums : {&arrivals_, &second_}) {
    ++sums->packets;
    sums->round_trip_sum_s += condition_.round_trip_s;
    sums->age_sum_s += packet.age_s;
  }
  link_totals_.round_trip_max_s = std::max(link_totals_.round_trip_max_s, condition_.round_trip_s);
  link_totals_.age_max_s = std::max(link_totals_.age_max_s, packet.age_s);
}

void SiteLoop::end_second() noexcept {
  const auto counters = endpoint_.counters();
  // The other's session may have begun anew; its counts then start from zero.
  const bool same = counters.expected >= second_expected_ && counters.arrived >= second_arrived_;
  const double expected = static_cast<double>(counters.expected - (same ? second_expected_ : 0));
  const double arrived = static_cast<double>(counters.arrived - (same ? second_arrived_ : 0));
  SiteSecond second = books_.end_second();
  second.round_trip_s = second_.mean(second_.round_trip_sum_s);
  second.age_s = second_.mean(second_.age_sum_s);
  second.loss_fraction = expected > 0.0 ? std::max(0.0, 1.0 - arrived / expected) : 0.0;
  console_.exchange().seconds.try_push(second);
  second_ = {};
  second_expected_ = counters.expected;
  second_arrived_ = counters.arrived;
  tell_misfit(counters.other_version);
}

void SiteLoop::tell_misfit(std::uint16_t other_version) noexcept {
  const auto& agreement =
      std::visit([](const auto& site) -> const control::AgreementCheck& { return site.agreement(); }, site_);
  const std::int64_t session = agreement.session();
  // Until all cells have come, or had a second for it.
  const bool known = agreement.complete() || session == listened_session_;
  if (other_version != told_version_) {
    told_version_ = other_version;
    console_.exchange().misfits.try_push({.other_version = other_version});
  } else if (agreement.disagrees() && known && session != told_session_) {
    told_session_ = session;
    console_.exchange().misfits.try_push({.agreement = agreement});
  }
  listened_session_ = session;
}

void SiteLoop::finish() noexcept {
  if (books_.in_a_second()) end_second();
}

LinkTotals SiteLoop::link_totals() const {
  LinkTotals totals = link_totals_;
  totals.round_trip_mean_s = arrivals_.mean(arrivals_.round_trip_sum_s);
  totals.age_mean_s = arrivals_.mean(arrivals_.age_sum_s);
  totals.link = endpoint_.counters();
  totals.dropped_by_kernel = endpoint_.socket().dropped();
  return totals;
}

}  // namespace tactus::runtime
