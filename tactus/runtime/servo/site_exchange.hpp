// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/ring.hpp>
#include <tactus/runtime/servo/end_request.hpp>
#include <tactus/runtime/servo/site_buttons.hpp>
#include <tactus/runtime/servo/site_counters.hpp>
#include <tactus/runtime/servo/site_mismatch.hpp>

#include <atomic>

namespace tactus::runtime {

/// What running sites and the rest of their program exchange. No locks.
struct SiteExchange {
  telemetry::Ring<SiteWord, 16> words;   ///< of the operator
  std::atomic<bool> person_lost{false};  ///< nobody holds the dead-man switch any more
  EndRequest end;
  telemetry::Ring<SiteSecond, 64> seconds;
  telemetry::Ring<SiteMismatch, 2> mismatches;  ///< each once
};

}  // namespace tactus::runtime
