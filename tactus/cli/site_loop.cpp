#include <tactus/cli/site_loop.hpp>
#include <tactus/simulation/model_mismatch.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::cli {

namespace {

constexpr double rest_s = 0.3;
constexpr double resuming_s = 1.0;

}  // namespace

RepeatedTaps::RepeatedTaps(const simulation::TappingParams& params) {
  const simulation::TapSeries& taps = params.task;
  const double depth_m = 0.5 * (taps.shallowest_m + taps.deepest_m);
  const double speed_m_per_s = 0.5 * (taps.slowest_m_per_s + taps.fastest_m_per_s);
  const double wall_m = params.environment.position_m / params.control.position_scale;
  const double reach_s = mechanics::MinimumJerk::duration_for(2.0 * depth_m, speed_m_per_s);
  there_ = {.start_m = wall_m - depth_m, .end_m = wall_m + depth_m, .start_time_s = rest_s, .duration_s = reach_s};
  back_ = {.start_m = 0.0,
           .end_m = -2.0 * depth_m,
           .start_time_s = rest_s + reach_s + taps.observation_s,
           .duration_s = reach_s};
  period_s_ = back_.start_time_s + reach_s;
}

double RepeatedTaps::position_m(double time_s) const noexcept {
  const double time_in_period_s = std::fmod(time_s, period_s_);
  return there_.position_m(time_in_period_s) + back_.position_m(time_in_period_s);
}

Result<SiteLoop> SiteLoop::make(const simulation::TappingParams& params, const Settings& settings,
                                SiteExchange& exchange) {
  if (auto error = validate(params)) return *std::move(error);
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const Seconds tick{clock->tick_s};
  control::ControlParams control = params.control;
  control.model = simulation::mismatched(control.model, params.task.mismatch);
  auto sites = control::make_sites(control, tick);
  if (!sites) return under("control", sites.error());

  const RepeatedTaps path(params);
  const double slave_start_m = control.position_scale * path.start_m();
  const bool is_master = settings.link.site == link::SiteName::master;
  auto work = [&]() -> Result<Work> {
    if (is_master) {
      const auto plant = simulation::MasterPlant::make(params.master, params.person, *clock, path.start_m());
      if (!plant) return plant.error();
      return Work(Master{.plant = *plant, .site = std::move(sites->master), .path = path, .clock = *clock});
    }
    const auto plant = simulation::SlavePlant::make(params.slave, params.environment, *clock, slave_start_m);
    if (!plant) return plant.error();
    return Work(Slave{.plant = *plant, .site = std::move(sites->slave), .clock = *clock});
  }();
  if (!work) return work.error();
  const auto following = link::Following::make(settings.following, tick, {.position_m = slave_start_m});
  if (!following) return following.error();
  auto endpoint = link::Endpoint::make(settings.link);
  if (!endpoint) return endpoint.error();
  const auto& gate = is_master ? control.gate : control.slave_gate;
  return SiteLoop(settings, exchange, *std::move(endpoint), *following, *std::move(work), tick.value,
                  gate.rate_limit_N_per_s * tick.value);
}

SiteLoop::SiteLoop(const Settings& settings, SiteExchange& exchange, link::Endpoint endpoint,
                   const link::Following& following, Work work, double tick_s, double force_step_limit_N)
    : settings_(settings),
      exchange_(&exchange),
      endpoint_(std::move(endpoint)),
      arming_(settings.link.site, settings.following.hold_after_s, tick_s),
      following_(following),
      work_(std::move(work)),
      tick_s_(tick_s),
      may_arm_at_once_(settings.arm_at_once) {
  totals_.force_step_limit_N = force_step_limit_N;
}

SiteLoop::Stepped SiteLoop::Master::step(const control::Arrival& arrival, bool active) noexcept {
  const auto reading = plant.measure();
  const auto output = site.step({.motor_position_m = reading.motor_position_m,
                                 .hand_force_N = reading.hand_force_N,
                                 .arrival = arrival,
                                 .grip = reading.grip});
  const double now_s = path_s;
  if (active) path_s += clock.tick_s;
  plant.begin_tick({.motor_force_N = output.motor_force_N, .handle_force_N = output.handle_force_N},
                   path.position_m(now_s), path.position_m(path_s));
  for (int i = 0; i < clock.substeps; ++i) plant.substep(i);
  return {.message = output.message,
          .motor_force_N = output.motor_force_N,
          .fault = site.fault() != control::GateFault::none};
}

SiteLoop::Stepped SiteLoop::Slave::step(const control::Arrival& arrival, bool) noexcept {
  const auto reading = plant.measure();
  const auto output =
      site.step({.motor_position_m = reading.motor_position_m, .tip_force_N = reading.tip_force_N, .arrival = arrival});
  plant.begin_tick(output.motor_force_N);
  for (int i = 0; i < clock.substeps; ++i) plant.substep(i);
  return {.message = output.message,
          .motor_force_N = output.motor_force_N,
          .fault = site.fault() != control::GateFault::none};
}

bool SiteLoop::operator()(const runtime::Tick& tick) noexcept {
  const std::int64_t now_ns = tick.began_ns;
  if (totals_.ticks == 0) {
    start_ns_ = now_ns;
    second_ends_ns_ = now_ns + 1'000'000'000;
  }
  const auto received = endpoint_.receive(now_ns);
  const link::Standing before = arming_.standing();
  if (received.heard) heard_s_ += tick_s_;
  // The slave follows a number that rises, so it must have heard the one before.
  const bool arm_at_once = may_arm_at_once_ && heard_s_ > settings_.following.hold_after_s;
  if (arm_at_once) may_arm_at_once_ = false;
  const bool arm = exchange_->arm.exchange(false, std::memory_order_relaxed) || arm_at_once;
  const link::Standing standing = arming_.step({.heard = received.heard,
                                                .silence_s = received.silence_s,
                                                .session = received.session,
                                                .peer = received.standing,
                                                .peer_armings = received.armings,
                                                .arm = arm,
                                                .fault = fault_});
  judge(received, before);
  const auto arrival =
      following_.step({.arrival = received.arrival, .silence_s = received.silence_s, .standing = standing});
  const bool active = standing == link::Standing::active;
  const Stepped stepped = std::visit([&](auto& work) { return work.step(arrival, active); }, work_);
  fault_ = stepped.fault;
  endpoint_.send(stepped.message, standing, arming_.armings(), now_ns);
  measure(stepped);

  ++totals_.ticks;
  totals_.active_ticks += active ? 1 : 0;
  totals_.duration_s = static_cast<double>(now_ns - start_ns_) * 1e-9;
  if (now_ns >= second_ends_ns_) end_second();
  return settings_.duration_s <= 0.0 || totals_.duration_s < settings_.duration_s;
}

void SiteLoop::judge(const link::Endpoint::Received& received, link::Standing before) noexcept {
  const link::Standing now = arming_.standing();
  ++ticks_since_arming_;
  if (before == link::Standing::hold && now == link::Standing::active) {
    ++totals_.armings;
    ticks_since_arming_ = 0;
  } else if (before == link::Standing::active && now == link::Standing::hold) {
    ++totals_.holds[static_cast<std::size_t>(arming_.cause())];
    totals_.longest_silence_at_hold_s = std::max(totals_.longest_silence_at_hold_s, received.silence_s);
  }
  if (!received.arrival.fresh) return;
  const bool older = received.session == last_session_ && received.sequence <= last_sequence_;
  if (older || received.age_s > settings_.link.longest_age_s) ++totals_.stale_applied;
  last_session_ = received.session;
  last_sequence_ = received.sequence;
  ++messages_;
  ++second_messages_;
  round_trip_sum_s_ += received.round_trip_s;
  second_round_trip_sum_s_ += received.round_trip_s;
  age_sum_s_ += received.age_s;
  second_age_sum_s_ += received.age_s;
  totals_.round_trip_max_s = std::max(totals_.round_trip_max_s, received.round_trip_s);
  totals_.age_max_s = std::max(totals_.age_max_s, received.age_s);
}

void SiteLoop::measure(const Stepped& stepped) noexcept {
  const double force_N = stepped.motor_force_N;
  if (!std::isfinite(force_N) || !control::is_finite(stepped.message)) ++totals_.not_finite;
  const double step_N = std::fabs(force_N - motor_force_N_);
  motor_force_N_ = force_N;
  constexpr double round_off = 1e-12;
  if (step_N > totals_.force_step_limit_N * (1.0 + round_off)) ++totals_.steps_above_limit;
  totals_.peak_force_N = std::max(totals_.peak_force_N, std::fabs(force_N));
  second_peak_N_ = std::max(second_peak_N_, std::fabs(force_N));
  totals_.largest_force_step_N = std::max(totals_.largest_force_step_N, step_N);
  if (totals_.armings > 0 && static_cast<double>(ticks_since_arming_) * tick_s_ < resuming_s) {
    totals_.largest_resuming_force_step_N = std::max(totals_.largest_resuming_force_step_N, step_N);
  }
}

void SiteLoop::end_second() noexcept {
  const auto counters = endpoint_.counters();
  // The other's session may have begun anew; its counts then start from zero.
  const bool same = counters.expected >= second_expected_ && counters.arrived >= second_arrived_;
  const double expected = static_cast<double>(counters.expected - (same ? second_expected_ : 0));
  const double arrived = static_cast<double>(counters.arrived - (same ? second_arrived_ : 0));
  const double messages = static_cast<double>(std::max<std::int64_t>(second_messages_, 1));
  exchange_->seconds.try_push({.time_s = static_cast<double>(second_ends_ns_ - start_ns_) * 1e-9,
                               .standing = arming_.standing(),
                               .cause = arming_.cause(),
                               .round_trip_s = second_round_trip_sum_s_ / messages,
                               .age_s = second_age_sum_s_ / messages,
                               .loss_fraction = expected > 0.0 ? std::max(0.0, 1.0 - arrived / expected) : 0.0,
                               .peak_force_N = second_peak_N_});
  second_ends_ns_ += 1'000'000'000;
  second_round_trip_sum_s_ = second_age_sum_s_ = second_peak_N_ = 0.0;
  second_messages_ = 0;
  second_expected_ = counters.expected;
  second_arrived_ = counters.arrived;
}

SiteTotals SiteLoop::totals() const {
  SiteTotals totals = totals_;
  if (messages_ > 0) {
    totals.round_trip_mean_s = round_trip_sum_s_ / static_cast<double>(messages_);
    totals.age_mean_s = age_sum_s_ / static_cast<double>(messages_);
  }
  totals.link = endpoint_.counters();
  return totals;
}

}  // namespace tactus::cli
