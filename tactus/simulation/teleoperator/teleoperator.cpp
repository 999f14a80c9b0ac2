// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <cstdint>
#include <string>
#include <type_traits>

namespace tactus::simulation {

namespace {

/// An arming that takes longer than this comes to nothing.
constexpr double arming_timeout_s = 5.0;

template <class Pair>
constexpr bool supervised = std::is_same_v<typename Pair::Request, control::SiteRequests>;

/// What a site's controller and gate put out, and what it tells the other site.
template <class Output>
const auto& gated(const Output& output) noexcept {
  if constexpr (requires { output.site; }) {
    return output.site;
  } else {
    return output;
  }
}
template <class Output>
const control::Message& told(const Output& output) noexcept {
  if constexpr (requires { output.packet; }) {
    return output.packet.message;
  } else {
    return output.message;
  }
}

/// What a person presses who wants the sites to follow: each button once more every other tick, until it was heard.
control::SiteRequests buttons(control::SiteState master, std::int64_t tick) {
  const bool pressed = tick % 2 == 1;
  return {.align = pressed && master == control::SiteState::configure,
          .arm = pressed && master == control::SiteState::align,
          .dead_man = master == control::SiteState::armed || master == control::SiteState::active};
}

}  // namespace

template <class Pair>
Result<TeleoperatorOf<Pair>> TeleoperatorOf<Pair>::make(const Params& params, double start_m) {
  if (auto error = validate(params)) return *std::move(error);
  const auto clock = Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const double slave_start_m = params.control.position_scale * start_m;
  auto master = MasterPlant::make(params.master, params.person, *clock, start_m);
  if (!master) return master.error();
  auto slave = SlavePlant::make(params.slave, params.environment, *clock, slave_start_m);
  if (!slave) return slave.error();
  auto sites = Pair::make(params.control, params.channel, Seconds{clock->tick_s}, slave_start_m);
  if (!sites) return sites.error();
  TeleoperatorOf made(*master, *slave, *std::move(sites), *clock);
  if constexpr (supervised<Pair>) {
    if (auto refused = made.arm(start_m, params.control.supervision.blend_s)) return *std::move(refused);
  }
  return made;
}

template <class Pair>
Check TeleoperatorOf<Pair>::arm(double start_m, double blend_s) {
  const auto whole_force_ticks = static_cast<std::int64_t>(blend_s / clock_.tick_s) + 1;
  const auto last = static_cast<std::int64_t>(arming_timeout_s / clock_.tick_s);
  std::int64_t to_follow = whole_force_ticks;
  while (to_follow > 0 && ticks_ < last) {
    advance(start_m, start_m, buttons(sites_.master().state(), ticks_));
    to_follow = stopped() ? whole_force_ticks : to_follow - 1;
  }
  ticks_ = 0;
  if (to_follow == 0) return std::nullopt;
  std::string why = "the sites do not follow " + rounded_number(arming_timeout_s) + " s after they were armed";
  if (const auto stop = stopped()) {
    why = "the sites cannot be armed: the " + std::string(name_of(stop->site)) + " stops for the cause \"" +
          std::string(name_of(stop->cause)) + "\"";
  }
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "control.supervision",
               .message = why + ": widen the limit of [control.supervision] that this is about",
               .place = {}};
}

template <class Pair>
std::optional<StoppedSite> TeleoperatorOf<Pair>::stopped() const noexcept {
  if constexpr (supervised<Pair>) {
    const auto& master = sites_.master();
    const auto& slave = sites_.slave();
    constexpr auto active = control::SiteState::active;
    if (master.state() == active && slave.state() == active) return std::nullopt;
    // A site that stops because the other did says so.
    if (master.state() != active && master.cause() != control::SiteCause::peer) {
      return StoppedSite{control::SiteRole::master, master.cause()};
    }
    return StoppedSite{control::SiteRole::slave, slave.cause()};
  } else {
    return std::nullopt;
  }
}

template <class Pair>
auto TeleoperatorOf<Pair>::step(double path_m, double path_at_next_tick_m, double share) noexcept -> Record {
  if constexpr (supervised<Pair>) {
    return advance(path_m, path_at_next_tick_m, {.dead_man = share > 0.0});
  } else {
    return advance(path_m, path_at_next_tick_m, share);
  }
}

/// Flat: a substep takes as long as some calls, and two kinds of pair share what they call, so it would be called.
template <class Pair>
[[gnu::flatten]] auto TeleoperatorOf<Pair>::advance(double path_m, double path_at_next_tick_m,
                                                    const typename Pair::Request& request) noexcept -> Record {
  const typename Pair::Output output = sites_.step(master_, slave_, {.number = ticks_}, request);
  Record record = recorded(static_cast<double>(ticks_) * clock_.tick_s, output);
  record.tip_position_m = slave_.tip_position_m();

  master_.begin_tick(path_m, path_at_next_tick_m);
  slave_.begin_tick();
  // In turns, so that the processor works on both at once.
  for (int i = 0; i < clock_.substeps; ++i) {
    master_.substep(i);
    slave_.substep(i);
  }
  add_contact(record, slave_.contact(), clock_);
  ++ticks_;
  return record;
}

template <class Pair>
auto TeleoperatorOf<Pair>::recorded(double time_s, const typename Pair::Output& output) noexcept -> Record {
  const auto& master = gated(output.master.output);
  Record record;
  record.time_s = time_s;
  record.master_position_m = output.master.reading.position_m;
  record.induced_position_m = master.induced_position_m;
  record.command_m = told(output.master.output).position_m;
  record.slave_position_m = output.slave.reading.position_m;
  record.displayed_force_N = -master.motor_force_N;
  record.handle_force_N = master.handle_force_N;
  record.hand_force_N = output.master.reading.force_N;
  record.sent_force_N = told(output.slave.output).force_N;
  record.estimated_grip = master.hand.estimated_grip;
  record.estimated_grip_deviation = master.hand.estimated_grip_deviation;
  return record;
}

template <class Pair>
void TeleoperatorOf<Pair>::add_contact(Record& record, const SlavePlant::Contact& contact,
                                       const Clock& clock) noexcept {
  record.contact_force_N = contact.sum_N / clock.substeps;
  record.peak_contact_force_N = contact.peak_N;
  record.touched = contact.touched;
  record.touched_at_s =
      contact.touched ? record.time_s + contact.touched_substep * clock.substep_s + contact.touched_after_s : 0.0;
}

template Result<TeleoperatorOf<station::BarePair>> TeleoperatorOf<station::BarePair>::make(const Params&, double);
template auto TeleoperatorOf<station::BarePair>::step(double, double, double) noexcept -> Record;
template auto TeleoperatorOf<station::BarePair>::recorded(double, const station::BarePair::Output&) noexcept -> Record;
template void TeleoperatorOf<station::BarePair>::add_contact(Record&, const SlavePlant::Contact&,
                                                             const Clock&) noexcept;
template std::optional<StoppedSite> TeleoperatorOf<station::BarePair>::stopped() const noexcept;
template Result<TeleoperatorOf<station::SupervisedPair>> TeleoperatorOf<station::SupervisedPair>::make(const Params&,
                                                                                                       double);
template auto TeleoperatorOf<station::SupervisedPair>::step(double, double, double) noexcept -> Record;
template auto TeleoperatorOf<station::SupervisedPair>::recorded(double, const station::SupervisedPair::Output&) noexcept
    -> Record;
template void TeleoperatorOf<station::SupervisedPair>::add_contact(Record&, const SlavePlant::Contact&,
                                                                   const Clock&) noexcept;
template std::optional<StoppedSite> TeleoperatorOf<station::SupervisedPair>::stopped() const noexcept;

}  // namespace tactus::simulation
