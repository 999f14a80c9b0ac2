// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/device_guard.hpp>
#include <tactus/kernel/station/teleoperator_params.hpp>
#include <tactus/runtime/servo/site_console.hpp>
#include <tactus/runtime/servo/site_device.hpp>
#include <tactus/runtime/servo/site_link.hpp>
#include <tactus/runtime/servo/site_log.hpp>
#include <tactus/runtime/servo/site_parts.hpp>

#include <memory>

namespace tactus::runtime {

/// One site of two: the link, a supervised site and its device. The step of a servo thread; does not allocate, lock or
/// block, as far as the device does not.
class SiteLoop {
 public:
  struct Settings {
    link::Endpoint::Settings link;
    double duration_s = 0.0;   ///< 0 for no end
    bool arm_at_once = false;  ///< the master, as soon as it receives the first packet of the slave
  };

  /// `exchange` must outlive the loop. A device that is not simulated is behind a device guard, and its limits
  /// must be set. Errors: what is wrong with the parameters, the device or the link.
  static Result<SiteLoop> make(const station::TeleoperatorParams& params, const Settings& settings,
                               SiteExchange& exchange, SiteDevice device);

  /// Every tick from now on goes there too. Before the first tick.
  void leave_in(const SiteStreams& streams) { streams_ = streams; }

  /// One tick; false once the site was to end and has no force any more.
  bool operator()(const station::Tick& tick) noexcept;

  /// Hands on the second that has begun. After the last tick, once.
  void finish() noexcept;
  /// After the last tick, as the next.
  [[nodiscard]] const SiteTotals& totals() const noexcept { return counters_.totals(); }
  [[nodiscard]] LinkTotals link_totals() const { return link_.totals(); }

 private:
  SiteLoop(const SiteConsole& console, const SiteCounters& counters, control::SiteRole role, SiteLink link,
           SupervisedSite site, SiteDevice device, std::unique_ptr<station::GuardedDevice> guard);
  void end_second() noexcept;

  SiteConsole console_;
  SiteCounters counters_;
  SiteStreams streams_;
  control::SiteRole role_;
  SiteLink link_;
  SupervisedSite site_;
  SiteDevice device_;
  std::unique_ptr<station::GuardedDevice> guard_;  ///< before a device that is not simulated
  station::Device* driven_;                        ///< the guard, or the device itself
};

}  // namespace tactus::runtime
