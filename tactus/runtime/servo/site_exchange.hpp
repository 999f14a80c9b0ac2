// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/ring.hpp>
#include <tactus/runtime/servo/end_request.hpp>
#include <tactus/runtime/servo/site_buttons.hpp>
#include <tactus/runtime/servo/site_counters.hpp>
#include <tactus/runtime/servo/site_mismatch.hpp>

#include <atomic>
#include <mutex>
#include <string_view>

namespace tactus::runtime {

/// What running sites and the rest of their program exchange. The sites take no lock.
struct SiteExchange {
  telemetry::Ring<SiteCommand, 16> words;     ///< of the operator, of pages and of nodes
  std::mutex asking;                          ///< of those who push them
  Settable settable;                          ///< by `allow`
  std::atomic<double> asked_force_gain{0.0};  ///< that of the file, then the newest that was asked for
  std::atomic<bool> person_lost{false};       ///< nobody holds the dead-man switch any more
  EndRequest end;
  telemetry::Ring<SiteSecond, 64> seconds;
  telemetry::Ring<SiteMismatch, 2> mismatches;  ///< each once

  /// What may be set. Before any thread starts.
  void allow(const Settable& what) {
    settable = what;
    asked_force_gain.store(what.file_force_gain, std::memory_order_relaxed);
  }
  /// Asks the sites for this; false where too much waits already. Any thread but theirs.
  [[nodiscard]] bool ask(const SiteCommand& command) {
    const std::scoped_lock lock(asking);
    if (!words.try_push(command)) return false;
    if (command.word == SiteWord::set) asked_force_gain.store(command.value, std::memory_order_relaxed);
    return true;
  }
  /// The same with a line of a page or a node for the site of this role. Errors: those of `parse_site_command`;
  /// `failed` where too much waits.
  Result<SiteCommand> ask(std::string_view line, control::SiteRole role, RequestSource source);
};

}  // namespace tactus::runtime
