#pragma once

#include <tactus/link/endpoint.hpp>
#include <tactus/runtime/site_console.hpp>
#include <tactus/runtime/site_device.hpp>
#include <tactus/runtime/site_log.hpp>
#include <tactus/runtime/site_parts.hpp>
#include <tactus/station/device_guard.hpp>

#include <cstdint>
#include <memory>

namespace tactus::runtime {

/// What came over the link, and what became of it.
struct LinkTotals {
  CountOfEach<control::PacketVerdict> packets;  ///< by what became of them
  double round_trip_mean_s = 0.0;
  double round_trip_max_s = 0.0;
  double age_mean_s = 0.0;
  double age_max_s = 0.0;
  std::int64_t stale_applied = 0;  ///< an older packet after a newer one, or one over age: must be 0
  link::Endpoint::Counters link;
  std::uint64_t dropped_by_kernel = 0;  ///< datagrams: none of the link by size and first bytes, or no room
};

/// One site of two: the link, a supervised site and its device. The step of a servo thread; does not allocate, lock or
/// block, as far as the device does not.
class SiteLoop {
 public:
  struct Settings {
    link::Endpoint::Settings link;
    double duration_s = 0.0;   ///< 0 for no end
    bool arm_at_once = false;  ///< the master, as soon as it hears the slave for the first time
  };

  /// `exchange` must outlive the loop. A device that is not simulated stands behind a wall, and needs limits that
  /// somebody chose. Errors: what is wrong with the parameters, the device or the link.
  static Result<SiteLoop> make(const experiments::TappingParams& params, const Settings& settings,
                               SiteExchange& exchange, SiteDevice device);

  /// Every tick from now on goes there too. Before the first tick.
  void leave_in(const SiteStreams& streams) { streams_ = streams; }

  /// One tick; false once the site was to end and has no force any more.
  bool operator()(const station::Tick& tick) noexcept;

  /// Hands on the second that has begun. After the last tick, once.
  void finish() noexcept;
  /// After the last tick, as the next.
  [[nodiscard]] const SiteTotals& totals() const noexcept { return books_.totals(); }
  [[nodiscard]] LinkTotals link_totals() const;

 private:
  struct LinkWay;

  /// Sums over applied packets.
  struct Arrivals {
    double round_trip_sum_s = 0.0;
    double age_sum_s = 0.0;
    std::int64_t packets = 0;
    [[nodiscard]] double mean(double sum_s) const noexcept {
      return packets > 0 ? sum_s / static_cast<double>(packets) : 0.0;
    }
  };

  SiteLoop(const SiteConsole& console, const SiteBooks& books, control::SiteRole role, link::Endpoint endpoint,
           SupervisedSite site, SiteDevice device, std::unique_ptr<station::GuardedDevice> wall, double longest_age_s);
  void count(const control::Packet& packet, control::PacketVerdict verdict) noexcept;
  void end_second() noexcept;
  void tell_misfit(std::uint16_t other_version) noexcept;

  SiteConsole console_;
  SiteBooks books_;
  SiteStreams streams_;
  control::SiteRole role_;
  link::Endpoint endpoint_;
  SupervisedSite site_;
  SiteDevice device_;
  std::unique_ptr<station::GuardedDevice> wall_;  ///< before a device that is not simulated
  station::Device* driven_;                       ///< the wall, or the device itself
  double longest_age_s_;
  link::Endpoint::Condition condition_;
  control::Packet newest_;  ///< that was applied
  LinkTotals link_totals_;
  Arrivals arrivals_;
  // Of the running second.
  Arrivals second_;
  std::uint64_t second_expected_ = 0, second_arrived_ = 0;
  // Of the misfits.
  std::int64_t listened_session_ = 0;  ///< that was heard when the second before ended
  std::int64_t told_session_ = 0;
  std::uint16_t told_version_ = 0;
};

}  // namespace tactus::runtime
