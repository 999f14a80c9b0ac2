// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/tick.hpp>
#include <tactus/runtime/link/endpoint.hpp>
#include <tactus/runtime/servo/site_counters.hpp>
#include <tactus/runtime/servo/site_exchange.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>

namespace tactus::runtime {

/// What came over the link, and what became of it.
struct LinkTotals {
  CountOfEach<control::PacketVerdict> packets;  ///< by what became of them
  double round_trip_mean_s = 0.0;
  double round_trip_max_s = 0.0;
  double age_mean_s = 0.0;
  double age_max_s = 0.0;
  std::int64_t stale_applied = 0;  ///< an older packet after a newer one, or one over age: must be 0
  link::LinkCounters link;
  std::uint64_t dropped_by_kernel = 0;  ///< datagrams: none of the link by size and first bytes, or no room
};

/// What came over the link in a second.
struct LinkSecond {
  double round_trip_s = 0.0;   ///< mean
  double age_s = 0.0;          ///< mean, of what was applied
  double loss_fraction = 0.0;  ///< of the other site's datagrams
};

/// The way of one site over a network, with the counters of what came on it: of one axis or of several joints. What
/// `station::step` asks of a way. Real-time safe but for `totals`.
template <class Payload>
class SiteLinkOf {
 public:
  using Packet = control::PacketOf<Payload>;

  /// `longest_age_s` is that of the site's packets.
  SiteLinkOf(link::EndpointOf<Payload> endpoint, double longest_age_s)
      : endpoint_(std::move(endpoint)), longest_age_s_(longest_age_s) {}

  template <class Take>
  void receive(const station::Tick& tick, Take&& take) noexcept {
    receive(tick, take, [](const Packet&) noexcept {});
  }
  /// The same; `see` is shown each packet after that.
  template <class Take, class See>
  void receive(const station::Tick& tick, Take&& take, See&& see) noexcept {
    const auto packets = endpoint_.receive(tick.began_ns);
    arrivals_now_ = static_cast<std::int64_t>(packets.size());
    condition_ = endpoint_.condition(tick.began_ns);
    for (const Packet& packet : packets) {
      count(packet, take(packet));
      see(packet);
    }
  }
  void send(const Packet& packet, const station::Tick& tick) noexcept { endpoint_.send(packet, tick.began_ns); }

  /// Of the latest tick.
  [[nodiscard]] const link::LinkCondition& condition() const noexcept { return condition_; }
  [[nodiscard]] std::int64_t arrivals() const noexcept { return arrivals_now_; }
  /// Whether a packet of the other site was applied, ever.
  [[nodiscard]] bool heard() const noexcept { return newest_session_ != 0; }

  /// What came since the second before. Once a second.
  LinkSecond end_second() noexcept;
  /// Reports once why the sites that receive packets of each other cannot work together. Once a second.
  void report_mismatch(const control::AgreementCheck& agreement, SiteExchange& exchange) noexcept;
  /// After the last tick.
  [[nodiscard]] LinkTotals totals() const;

 private:
  /// Sums over applied packets.
  struct Arrivals {
    double round_trip_sum_s = 0.0;
    double age_sum_s = 0.0;
    std::int64_t packets = 0;
    [[nodiscard]] double mean(double sum_s) const noexcept {
      return packets > 0 ? sum_s / static_cast<double>(packets) : 0.0;
    }
  };
  void count(const Packet& packet, control::PacketVerdict verdict) noexcept;
  KeyTrouble key_trouble(const link::LinkCounters& now) noexcept;

  link::EndpointOf<Payload> endpoint_;
  double longest_age_s_;
  link::LinkCondition condition_;
  std::int64_t arrivals_now_ = 0;
  std::int64_t newest_session_ = 0, newest_sequence_ = 0;  ///< of what was applied
  LinkTotals totals_;
  Arrivals arrivals_;
  // Of the running second.
  Arrivals second_;
  std::uint64_t second_expected_ = 0, second_arrived_ = 0;
  // Of the mismatches.
  std::int64_t listened_session_ = 0;  ///< that was received when the second before ended
  int listened_s_ = 0;                 ///< for how many seconds
  std::int64_t told_session_ = 0;
  std::uint16_t told_version_ = 0;
  std::size_t told_joints_ = 0;
  KeyTrouble told_keys_ = KeyTrouble::none;
  link::LinkCounters counted_;  ///< when the second before ended
};
/// A link, and `see(tick, packet)` for each packet that comes on it: the way of a site that leaves a log.
template <class Payload, class See>
struct SeenLink {
  SiteLinkOf<Payload>& link;
  See see;

  template <class Take>
  void receive(const station::Tick& tick, Take&& take) noexcept {
    link.receive(tick, take, [&](const control::PacketOf<Payload>& packet) noexcept { see(tick, packet); });
  }
  void send(const control::PacketOf<Payload>& packet, const station::Tick& tick) noexcept { link.send(packet, tick); }
};
template <class Payload, class See>
SeenLink(SiteLinkOf<Payload>&, See) -> SeenLink<Payload, See>;

using SiteLink = SiteLinkOf<control::Message>;
using JointSiteLink = SiteLinkOf<Joints<control::Message>>;

}  // namespace tactus::runtime
