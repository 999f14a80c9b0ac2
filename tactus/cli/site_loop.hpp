#pragma once

#include <tactus/cli/site_buttons.hpp>
#include <tactus/cli/site_device.hpp>
#include <tactus/cli/site_exchange.hpp>
#include <tactus/cli/site_log.hpp>
#include <tactus/control/supervised_site.hpp>
#include <tactus/experiments/tapping/tapping.hpp>
#include <tactus/link/endpoint.hpp>
#include <tactus/runtime/servo_thread.hpp>
#include <tactus/station/device_guard.hpp>
#include <tactus/station/step.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <variant>

namespace tactus::cli {

/// How many there are of each value of an enum that begins at 0 and leaves none out.
template <class Word>
struct CountOfEach {
  std::array<std::int64_t, enumerators(Word{}).size()> counts{};
  std::int64_t& operator[](Word word) noexcept { return counts[static_cast<std::size_t>(word)]; }
  std::int64_t operator[](Word word) const noexcept { return counts[static_cast<std::size_t>(word)]; }
};

/// What a site went through.
struct SiteTotals {
  double duration_s = 0.0;
  std::int64_t ticks = 0;
  CountOfEach<control::SiteState> ticks_in;         ///< by state
  CountOfEach<control::ActiveLimit> ticks_limited;  ///< by what changed the force
  CountOfEach<control::SiteCause> holds;            ///< by what led into hold
  CountOfEach<control::GateFault> faults;           ///< by what the gate latched
  CountOfEach<control::PacketVerdict> packets;      ///< by what became of them
  std::int64_t armings = 0;                         ///< out of align or hold
  double longest_silence_at_hold_s = 0.0;
  double round_trip_mean_s = 0.0;
  double round_trip_max_s = 0.0;
  double age_mean_s = 0.0;
  double age_max_s = 0.0;
  double peak_force_N = 0.0;
  double largest_force_step_N = 0.0;           ///< of the motor from tick to tick
  double largest_resuming_force_step_N = 0.0;  ///< the same in the first second after the site became active
  double force_step_limit_N = 0.0;             ///< what the gate allows
  std::int64_t steps_above_limit = 0;
  std::int64_t stale_applied = 0;  ///< an older packet after a newer one, or one over age: must be 0
  std::int64_t not_finite = 0;     ///< forces or messages that are not finite: must be 0
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

  /// Every tick from now on goes there too. Before the first tick; what `streams` points to must outlive the last.
  void log_to(const SiteStreams& streams) noexcept { streams_ = streams; }

  /// One tick. After `duration_s`, or once the end is asked for, the site leaves what it does and its forces go; false
  /// when they are gone. False at once where the end is insisted on.
  bool operator()(const station::Tick& tick) noexcept;

  /// Hands on the second that has begun. After the last tick, once.
  void finish() noexcept;
  /// After the last tick.
  [[nodiscard]] SiteTotals totals() const;

 private:
  struct LinkWay;
  using Site = std::variant<control::SupervisedMaster, control::SupervisedSlave>;

  /// Sums over applied packets.
  struct Arrivals {
    double round_trip_sum_s = 0.0;
    double age_sum_s = 0.0;
    std::int64_t packets = 0;
    [[nodiscard]] double mean(double sum_s) const noexcept {
      return packets > 0 ? sum_s / static_cast<double>(packets) : 0.0;
    }
  };

  SiteLoop(const Settings& settings, SiteExchange& exchange, link::Endpoint endpoint, Site site, SiteDevice device,
           std::unique_ptr<station::GuardedDevice> wall, double tick_s, const control::SupervisionParams& supervision,
           double force_step_limit_N);
  void count(const control::Packet& packet, control::PacketVerdict verdict) noexcept;
  template <class Supervised>
  [[nodiscard]] SiteLogRecord recorded(const station::Tick& tick, const station::Step<Supervised>& done) const noexcept;
  control::SiteRequests requests() noexcept;
  /// Whether the site is about to end and has no force any more, or took too long to lose it.
  [[nodiscard]] bool ended(const SiteLogRecord& record, std::int64_t elapsed_ticks) noexcept;
  void judge(control::SiteState before, const SiteLogRecord& record) noexcept;
  void measure(const SiteLogRecord& record) noexcept;
  void log(const station::Tick& tick, const SiteLogRecord& record) noexcept;
  void end_second() noexcept;
  void tell_misfit(std::uint16_t other_version) noexcept;
  [[nodiscard]] control::SiteState state() const noexcept {
    return std::visit([](const auto& site) { return site.state(); }, site_);
  }

  Settings settings_;
  SiteExchange* exchange_;
  SiteStreams streams_;
  link::Endpoint endpoint_;
  SiteButtons buttons_;
  Site site_;
  SiteDevice device_;
  std::unique_ptr<station::GuardedDevice> wall_;  ///< before a device that is not simulated
  station::Device* driven_;                       ///< the wall, or the device itself
  double tick_s_;
  double longest_age_s_;
  double listen_before_arming_s_;
  bool may_arm_at_once_;
  double heard_s_ = 0.0;  ///< since the other site was heard first
  bool leaving_ = false;
  double leaving_s_ = 0.0;
  link::Endpoint::Condition condition_;
  control::Packet newest_;  ///< that was applied
  SiteLogRecord last_;      ///< of the tick before
  std::int64_t ticks_since_active_ = 0;
  SiteTotals totals_;
  Arrivals arrivals_;
  std::int64_t start_ns_ = 0;
  // Of the running second.
  std::int64_t second_ends_ns_ = 0;
  Arrivals second_;
  std::int64_t second_ticks_ = 0;
  double second_peak_N_ = 0.0;
  std::uint64_t second_expected_ = 0, second_arrived_ = 0;
  // Of the misfits.
  std::int64_t listened_session_ = 0;  ///< that was heard when the second before ended
  std::int64_t told_session_ = 0;
  std::uint16_t told_version_ = 0;
};

}  // namespace tactus::cli
