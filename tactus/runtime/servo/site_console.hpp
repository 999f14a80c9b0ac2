// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/tick.hpp>
#include <tactus/runtime/servo/site_exchange.hpp>

#include <cstdint>
#include <optional>

namespace tactus::runtime {

/// Requests to running sites, tick by tick: what the operator presses, when they shall end, when a second is over.
/// A value; real-time safe.
class SiteConsole {
 public:
  struct Settings {
    double duration_s = 0.0;              ///< 0 for no end
    bool arm_at_once = false;             ///< once the other site was received for `listen_before_arming_s`
    double listen_before_arming_s = 0.0;  ///< the slave follows a number that rises, so it must have one before
    double tick_s = 0.0;
  };

  /// `exchange` must outlive it.
  SiteConsole(const Settings& settings, SiteExchange& exchange) : settings_(settings), exchange_(&exchange) {}

  /// No force from the next tick on is asked for.
  [[nodiscard]] bool insisted() const noexcept { return exchange_->end.insisted(); }
  /// What is pressed at this tick. `state` is that of the operator's site, after the tick before; `heard`
  /// whether a packet of the other site was received by then.
  control::SiteRequests step(const station::Tick& tick, control::SiteState state, bool heard) noexcept;
  /// What the operator marked at this tick, after `step`.
  [[nodiscard]] std::optional<EpisodeMark> mark() const noexcept { return mark_; }
  /// What was asked for at this tick, whoever did, after `step`.
  [[nodiscard]] const std::optional<SiteCommand>& taken() const noexcept { return taken_; }
  /// Whether a second is over with this tick. Once, after `step`.
  bool ends_second() noexcept;
  /// Whether it is all over: sites that are about to end do not work any more, and give no force or took too long to
  /// lose it. Once, after `step`.
  bool over(const station::Tick& tick, bool works, bool gives_force) noexcept;

  /// Whether the sites are to end: their duration is over, or their end was requested.
  [[nodiscard]] bool leaving() const noexcept { return leaving_; }
  /// From the first tick to the latest.
  [[nodiscard]] double time_s() const noexcept { return time_s_; }
  [[nodiscard]] SiteExchange& exchange() const noexcept { return *exchange_; }

 private:
  Settings settings_;
  SiteExchange* exchange_;
  SiteButtons buttons_;
  std::optional<EpisodeMark> mark_;
  std::optional<SiteCommand> taken_;
  bool begun_ = false;
  std::int64_t start_ns_ = 0;
  std::int64_t now_ns_ = 0;
  std::int64_t second_ends_ns_ = 0;
  double time_s_ = 0.0;
  double heard_s_ = 0.0;  ///< since the first packet of the other site
  bool leaving_ = false;
  double leaving_s_ = 0.0;
};

}  // namespace tactus::runtime
