#include <tactus/cli/site_loop.hpp>
#include <tactus/control/agreed_parameters.hpp>
#include <tactus/experiments/model_mismatch.hpp>
#include <tactus/station/wall.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace tactus::cli {

namespace {

constexpr double resuming_s = 1.0;

}  // namespace

Result<SiteLoop> SiteLoop::make(const experiments::TappingParams& params, const Settings& settings,
                                SiteExchange& exchange, SiteDevice device) {
  if (auto error = validate(params)) return *std::move(error);
  const Seconds tick{1.0 / params.servo.rate_Hz};
  control::ControlParams control = params.control;
  control.model = experiments::mismatched(control.model, params.task.mismatch);
  const control::SiteRole role = settings.link.site;
  auto wall = station::wall_before(*device.device, control, role);
  if (!wall) return wall.error();
  auto endpoint = link::Endpoint::make(settings.link);
  if (!endpoint) return endpoint.error();
  const control::ControlParams own = station::tightened(control, role, device.device->limits());
  // What the device allows is this site's own affair.
  const control::Agreement agreement = control::agreement_of(control, tick);
  auto site = [&]() -> Result<Site> {
    if (role == control::SiteRole::master) {
      auto made = control::make_supervised_master(own, endpoint->session(), tick, agreement);
      if (!made) return under("control", made.error());
      return Site(*std::move(made));
    }
    auto made = control::make_supervised_slave(own, endpoint->session(), tick, agreement);
    if (!made) return under("control", made.error());
    return Site(*std::move(made));
  }();
  if (!site) return site.error();
  const auto& gate = role == control::SiteRole::master ? own.gate : own.slave_gate;
  return SiteLoop(settings, exchange, *std::move(endpoint), *std::move(site), std::move(device), *std::move(wall),
                  tick.value, control.supervision, gate.rate_limit_N_per_s * tick.value);
}

SiteLoop::SiteLoop(const Settings& settings, SiteExchange& exchange, link::Endpoint endpoint, Site site,
                   SiteDevice device, std::unique_ptr<station::GuardedDevice> wall, double tick_s,
                   const control::SupervisionParams& supervision, double force_step_limit_N)
    : settings_(settings),
      exchange_(&exchange),
      endpoint_(std::move(endpoint)),
      site_(std::move(site)),
      device_(std::move(device)),
      wall_(std::move(wall)),
      driven_(wall_ ? wall_.get() : device_.device.get()),
      tick_s_(tick_s),
      longest_age_s_(supervision.packets.longest_age_s),
      listen_before_arming_s_(supervision.watchdog.timeout_s),
      may_arm_at_once_(settings.arm_at_once) {
  totals_.force_step_limit_N = force_step_limit_N;
}

/// The way of the site: the link, and the books of what came on it.
struct SiteLoop::LinkWay {
  SiteLoop& loop;
  template <class Take>
  void receive(const station::Tick& tick, Take&& take) noexcept {
    const auto packets = loop.endpoint_.receive(tick.began_ns);
    loop.condition_ = loop.endpoint_.condition(tick.began_ns);
    for (const control::Packet& packet : packets) loop.count(packet, take(packet));
  }
  void send(const control::Packet& packet, const station::Tick& tick) noexcept {
    loop.endpoint_.send(packet, tick.began_ns);
  }
};

template <class Supervised>
SiteLogRecord SiteLoop::recorded(const station::Tick& tick, const station::Step<Supervised>& done) const noexcept {
  SiteLogRecord record{done.output.record};
  record.tick = tick.number;
  record.missed = tick.missed;
  record.age_s = newest_.age_s;
  record.round_trip_s = condition_.round_trip_s;
  record.link_silence_s = condition_.silence_s;
  record.position_m = done.reading.position_m;
  record.read_force_N = done.reading.force_N;
  record.motor_force_N = done.output.site.motor_force_N;
  if constexpr (std::is_same_v<Supervised, control::SupervisedMaster>) {
    record.grip = done.reading.grip;
    record.handle_force_N = done.output.site.handle_force_N;
    record.induced_position_m = done.output.site.induced_position_m;
    record.intended_position_m = done.output.site.intended_position_m;
  }
  record.hear(newest_.message);
  record.tell(done.output.packet);
  return record;
}

bool SiteLoop::operator()(const station::Tick& tick) noexcept {
  if (exchange_->end.insisted()) {
    driven_->write({.enabled = false});
    return false;
  }
  const std::int64_t now_ns = tick.began_ns;
  if (totals_.ticks == 0) {
    start_ns_ = now_ns;
    second_ends_ns_ = now_ns + 1'000'000'000;
  }
  const control::SiteState before = state();
  const control::SiteRequests pressed = requests();
  const SiteLogRecord record = std::visit(
      [&](auto& site) noexcept {
        LinkWay way{*this};
        return recorded(tick, station::step(site, *driven_, way, tick, pressed));
      },
      site_);
  if (device_.person != nullptr) device_.person->follow(state() == control::SiteState::active);
  judge(before, record);
  measure(record);
  log(tick, record);
  last_ = record;

  ++totals_.ticks;
  ++second_ticks_;
  totals_.duration_s = static_cast<double>(now_ns - start_ns_) * 1e-9;
  if (now_ns >= second_ends_ns_) {
    end_second();
    second_ends_ns_ += 1'000'000'000;
  }
  if (settings_.duration_s > 0.0 && totals_.duration_s >= settings_.duration_s) leaving_ = true;
  return !ended(record, tick.missed + 1);
}

bool SiteLoop::ended(const SiteLogRecord& record, std::int64_t elapsed_ticks) noexcept {
  const bool works = state() != control::SiteState::configure && state() != control::SiteState::fault;
  // What was asked for after this tick's step is heard at the next.
  if (!leaving_ || works) return false;
  leaving_s_ += static_cast<double>(elapsed_ticks) * tick_s_;
  return (record.motor_force_N == 0.0 && record.handle_force_N == 0.0) || leaving_s_ >= runtime::longest_ramp_s;
}

void SiteLoop::count(const control::Packet& packet, control::PacketVerdict verdict) noexcept {
  ++totals_.packets[verdict];
  if (verdict != control::PacketVerdict::applied) return;
  const bool older = packet.session == newest_.session && packet.sequence <= newest_.sequence;
  if (older || packet.age_s > longest_age_s_) ++totals_.stale_applied;
  newest_ = packet;
  for (Arrivals* sums : {&arrivals_, &second_}) {
    ++sums->packets;
    sums->round_trip_sum_s += condition_.round_trip_s;
    sums->age_sum_s += packet.age_s;
  }
  totals_.round_trip_max_s = std::max(totals_.round_trip_max_s, condition_.round_trip_s);
  totals_.age_max_s = std::max(totals_.age_max_s, packet.age_s);
}

control::SiteRequests SiteLoop::requests() noexcept {
  if (exchange_->end.asked()) leaving_ = true;
  if (exchange_->person_lost.load(std::memory_order_relaxed)) buttons_.lose_person();
  if (newest_.session != 0) heard_s_ += tick_s_;
  if (buttons_.ready()) {
    SiteWord word{};
    // The slave follows a number that rises, so it must have heard the one before.
    if (may_arm_at_once_ && heard_s_ > listen_before_arming_s_) {
      may_arm_at_once_ = false;
      buttons_.take(SiteWord::arm);
    } else if (exchange_->words.try_pop(word)) {
      buttons_.take(word);
    }
  }
  control::SiteRequests pressed = buttons_.step(state());
  pressed.leave = leaving_;
  return pressed;
}

void SiteLoop::judge(control::SiteState before, const SiteLogRecord& record) noexcept {
  using control::SiteState;
  const SiteState now = state();
  ++totals_.ticks_in[now];
  ++totals_.ticks_limited[static_cast<control::ActiveLimit>(record.limit)];
  ++ticks_since_active_;
  if (now == before) return;
  if (now == SiteState::armed && (before == SiteState::align || before == SiteState::hold)) ++totals_.armings;
  if (now == SiteState::active) ticks_since_active_ = 0;
  if (now == SiteState::fault) ++totals_.faults[static_cast<control::GateFault>(record.fault)];
  if (now == SiteState::hold) {
    ++totals_.holds[static_cast<control::SiteCause>(record.cause)];
    totals_.longest_silence_at_hold_s = std::max(totals_.longest_silence_at_hold_s, record.silence_s);
  }
}

void SiteLoop::measure(const SiteLogRecord& record) noexcept {
  const double force_N = record.motor_force_N;
  if (!std::isfinite(force_N) || !control::is_finite(record.told())) ++totals_.not_finite;
  const double step_N = std::fabs(force_N - last_.motor_force_N);
  constexpr double round_off = 1e-12;
  if (step_N > totals_.force_step_limit_N * (1.0 + round_off)) ++totals_.steps_above_limit;
  totals_.peak_force_N = std::max(totals_.peak_force_N, std::fabs(force_N));
  second_peak_N_ = std::max(second_peak_N_, std::fabs(force_N));
  totals_.largest_force_step_N = std::max(totals_.largest_force_step_N, step_N);
  if (totals_.ticks_in[control::SiteState::active] > 0 &&
      static_cast<double>(ticks_since_active_) * tick_s_ < resuming_s) {
    totals_.largest_resuming_force_step_N = std::max(totals_.largest_resuming_force_step_N, step_N);
  }
}

void SiteLoop::log(const station::Tick& tick, const SiteLogRecord& record) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - streams_.origin_ns);
  if (streams_.site != nullptr) streams_.site->push(due_ns, record);
  if (streams_.servo != nullptr) streams_.servo->push(due_ns, runtime::recorded(tick));
}

void SiteLoop::end_second() noexcept {
  const auto counters = endpoint_.counters();
  // The other's session may have begun anew; its counts then start from zero.
  const bool same = counters.expected >= second_expected_ && counters.arrived >= second_arrived_;
  const double expected = static_cast<double>(counters.expected - (same ? second_expected_ : 0));
  const double arrived = static_cast<double>(counters.arrived - (same ? second_arrived_ : 0));
  exchange_->seconds.try_push({.time_s = totals_.duration_s,
                               .state = static_cast<control::SiteState>(last_.state),
                               .cause = static_cast<control::SiteCause>(last_.cause),
                               .limit = static_cast<control::ActiveLimit>(last_.limit),
                               .fault = static_cast<control::GateFault>(last_.fault),
                               .round_trip_s = second_.mean(second_.round_trip_sum_s),
                               .age_s = second_.mean(second_.age_sum_s),
                               .loss_fraction = expected > 0.0 ? std::max(0.0, 1.0 - arrived / expected) : 0.0,
                               .peak_force_N = second_peak_N_});
  second_ = {};
  second_ticks_ = 0;
  second_peak_N_ = 0.0;
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
    exchange_->misfits.try_push({.other_version = other_version});
  } else if (agreement.disagrees() && known && session != told_session_) {
    told_session_ = session;
    exchange_->misfits.try_push({.agreement = agreement});
  }
  listened_session_ = session;
}

void SiteLoop::finish() noexcept {
  if (second_ticks_ > 0) end_second();
}

SiteTotals SiteLoop::totals() const {
  SiteTotals totals = totals_;
  totals.round_trip_mean_s = arrivals_.mean(arrivals_.round_trip_sum_s);
  totals.age_mean_s = arrivals_.mean(arrivals_.age_sum_s);
  totals.link = endpoint_.counters();
  totals.dropped_by_kernel = endpoint_.socket().dropped();
  return totals;
}

}  // namespace tactus::cli
