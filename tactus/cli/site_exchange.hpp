#pragma once

#include <tactus/cli/site_buttons.hpp>
#include <tactus/cli/site_misfit.hpp>
#include <tactus/control/safety_gate.hpp>
#include <tactus/runtime/end_request.hpp>
#include <tactus/telemetry/ring.hpp>

#include <atomic>

namespace tactus::cli {

/// One second of a site, for the display. State, cause, limit and fault are those of its end.
struct SiteSecond {
  double time_s = 0.0;  ///< of its end, since the start
  control::SiteState state = control::SiteState::configure;
  control::SiteCause cause = control::SiteCause::started;
  control::ActiveLimit limit = control::ActiveLimit::none;
  control::GateFault fault = control::GateFault::none;
  double round_trip_s = 0.0;  ///< mean over the packets that were applied in the second, as age
  double age_s = 0.0;
  double loss_fraction = 0.0;
  double peak_force_N = 0.0;  ///< of the motor, either way
};

/// What a running site and the rest of its program tell one another. No locks.
struct SiteExchange {
  telemetry::Ring<SiteWord, 16> words;   ///< of the person
  std::atomic<bool> person_lost{false};  ///< nobody holds the dead-man switch any more
  runtime::EndRequest end;
  telemetry::Ring<SiteSecond, 64> seconds;
  telemetry::Ring<SiteMisfit, 2> misfits;  ///< each once
};

}  // namespace tactus::cli
