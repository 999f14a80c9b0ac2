// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/site_link.hpp>

#include <algorithm>
#include <utility>

namespace tactus::runtime {

template <class Payload>
void SiteLinkOf<Payload>::count(const Packet& packet, control::PacketVerdict verdict) noexcept {
  ++totals_.packets[verdict];
  if (verdict != control::PacketVerdict::applied) return;
  const bool older = packet.session == newest_session_ && packet.sequence <= newest_sequence_;
  if (older || packet.age_s > longest_age_s_) ++totals_.stale_applied;
  newest_session_ = packet.session;
  newest_sequence_ = packet.sequence;
  for (Arrivals* sums : {&arrivals_, &second_}) {
    ++sums->packets;
    sums->round_trip_sum_s += condition_.round_trip_s;
    sums->age_sum_s += packet.age_s;
  }
  totals_.round_trip_max_s = std::max(totals_.round_trip_max_s, condition_.round_trip_s);
  totals_.age_max_s = std::max(totals_.age_max_s, packet.age_s);
}

template <class Payload>
LinkSecond SiteLinkOf<Payload>::end_second() noexcept {
  const auto counters = endpoint_.counters();
  // The other's session may have begun anew; its counts then start from zero.
  const bool same = counters.expected >= second_expected_ && counters.arrived >= second_arrived_;
  const double expected = static_cast<double>(counters.expected - (same ? second_expected_ : 0));
  const double arrived = static_cast<double>(counters.arrived - (same ? second_arrived_ : 0));
  const LinkSecond second{.round_trip_s = second_.mean(second_.round_trip_sum_s),
                          .age_s = second_.mean(second_.age_sum_s),
                          .loss_fraction = expected > 0.0 ? std::max(0.0, 1.0 - arrived / expected) : 0.0};
  second_ = {};
  second_expected_ = counters.expected;
  second_arrived_ = counters.arrived;
  return second;
}

/// Of the second that ended. Where anything came over the link, the keys are the same.
template <class Payload>
KeyTrouble SiteLinkOf<Payload>::key_trouble(const link::LinkCounters& now) noexcept {
  const link::LinkCounters before = std::exchange(counted_, now);
  if (now.inbound.counted > before.inbound.counted) return KeyTrouble::none;
  if (now.secure.forged > before.secure.forged) return KeyTrouble::other_key;
  if (now.secure.plain > before.secure.plain) return KeyTrouble::other_none;
  return now.keyed > before.keyed ? KeyTrouble::own_none : KeyTrouble::none;
}

template <class Payload>
void SiteLinkOf<Payload>::report_mismatch(const control::AgreementCheck& agreement, SiteExchange& exchange) noexcept {
  const auto counters = endpoint_.counters();
  const std::int64_t session = agreement.session();
  // Until all cells have come, or those that did have shown a difference, or no more are to be waited for.
  constexpr int longest_s = 10;
  listened_s_ = session == listened_session_ ? listened_s_ + 1 : 0;
  const bool shown = listened_s_ > 0 && agreement.first_difference() != 0;
  const bool known = agreement.complete() || shown || listened_s_ >= longest_s;
  const KeyTrouble keys = key_trouble(counters);
  if (keys != KeyTrouble::none && keys != told_keys_) {
    told_keys_ = keys;
    exchange.mismatches.try_push({.keys = keys});
  } else if (counters.other_version != told_version_) {
    told_version_ = counters.other_version;
    exchange.mismatches.try_push({.other_version = told_version_});
  } else if (counters.other_joints != told_joints_) {
    told_joints_ = counters.other_joints;
    exchange.mismatches.try_push({.other_joints = told_joints_});
  } else if (agreement.disagrees() && known && session != told_session_) {
    told_session_ = session;
    exchange.mismatches.try_push({.agreement = agreement});
  }
  listened_session_ = session;
}

template <class Payload>
LinkTotals SiteLinkOf<Payload>::totals() const {
  LinkTotals totals = totals_;
  totals.round_trip_mean_s = arrivals_.mean(arrivals_.round_trip_sum_s);
  totals.age_mean_s = arrivals_.mean(arrivals_.age_sum_s);
  totals.link = endpoint_.counters();
  totals.dropped_by_kernel = endpoint_.socket().dropped();
  return totals;
}

template class SiteLinkOf<control::Message>;
template class SiteLinkOf<Joints<control::Message>>;

}  // namespace tactus::runtime
