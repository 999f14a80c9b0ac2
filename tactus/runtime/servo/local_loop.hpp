// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/kernel/station/teleoperator_params.hpp>
#include <tactus/runtime/servo/site_console.hpp>
#include <tactus/runtime/servo/site_device.hpp>
#include <tactus/runtime/servo/site_log.hpp>

#include <array>

namespace tactus::runtime {

/// Both sites on one computer, supervised, each with its device. The step of a servo thread; does not allocate, lock or
/// block, as far as the devices do not.
class LocalLoop {
 public:
  struct Settings {
    double duration_s = 0.0;   ///< 0 for no end
    bool arm_at_once = false;  ///< without waiting for the operator to do it
  };

  /// `exchange` must outlive the loop. A device that is not simulated is behind a device guard, and its limits
  /// must be set. Errors: what is wrong with the parameters or the devices.
  static Result<LocalLoop> make(const station::TeleoperatorParams& params, const Settings& settings,
                                SiteExchange& exchange, SiteDevice master, SiteDevice slave);

  /// Every tick from now on goes there too. Before the first tick.
  void leave_in(const SiteStreams& streams) { streams_ = streams; }

  /// One tick; false once the sites were to end and have no force any more.
  bool operator()(const station::Tick& tick) noexcept;

  /// Hands on the second that has begun. After the last tick, once.
  void finish() noexcept;
  /// By role, after the last tick.
  [[nodiscard]] const SiteTotals& totals(control::SiteRole role) const noexcept {
    return counters_[static_cast<std::size_t>(role)].totals();
  }

 private:
  LocalLoop(const SiteConsole& console, const std::array<SiteCounters, 2>& counters, SiteDevice master,
            SiteDevice slave, station::LocalTeleoperator pair)
      : console_(console),
        counters_(counters),
        master_(std::move(master)),
        slave_(std::move(slave)),
        pair_(std::move(pair)) {}
  void end_second() noexcept;

  SiteConsole console_;
  std::array<SiteCounters, 2> counters_;  ///< by role
  SiteStreams streams_;
  SiteDevice master_;
  SiteDevice slave_;
  station::LocalTeleoperator pair_;
};

}  // namespace tactus::runtime
