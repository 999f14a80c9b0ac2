// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus::devices {

/// A motor that is to have no power is commanded so in every cycle of its bus. One that has not reported for this long
/// that it is off counts as one that stays on.
inline constexpr std::int64_t off_within_ns = 100'000'000;

/// Whether a motor that is to have no power has reported, after the command, that it is off. A report that is missing
/// or not known counts as power. Trivially copyable, real-time safe.
class OffWatch {
 public:
  OffWatch() = default;
  /// So many reports in a row, where one alone may be the late answer to a command from before.
  explicit OffWatch(int enough_reports) noexcept : enough_reports_(enough_reports) {}

  /// The motor is to have power: whatever it reported before is void.
  void start_over() noexcept { *this = OffWatch(enough_reports_); }
  /// The motor was commanded to switch off.
  void told(std::int64_t now_ns) noexcept {
    if (told_ == 0) first_told_ns_ = now_ns;
    ++told_;
    last_told_ns_ = now_ns;
  }
  /// The motor reported whether it is off. What it reports before the command is no reply to it.
  void reported(bool off) noexcept {
    if (!off && confirmed()) start_over();
    if (told_ == 0) return;
    off_reports_ = off ? off_reports_ + 1 : 0;
    if (!off) ++on_reports_;
  }
  [[nodiscard]] bool confirmed() const noexcept { return off_reports_ >= enough_reports_; }
  /// It was commanded for `off_within_ns`, it answered, and it is not off.
  [[nodiscard]] bool stays_on(std::int64_t now_ns) const noexcept {
    return late(now_ns) && on_reports_ >= enough_to_blame;
  }
  /// Whether to command it (again) now: in each cycle at first. A motor that does not switch off is left in peace for
  /// `rest_ns` after that, longer than its own watchdog waits, for whatever it is sent feeds that watchdog.
  [[nodiscard]] bool due(std::int64_t now_ns, std::int64_t rest_ns) const noexcept {
    return confirmed() || !late(now_ns) || now_ns - last_told_ns_ >= rest_ns;
  }

 private:
  static constexpr int enough_to_blame = 3, enough_times = 5;
  /// Once is not enough: where this program was stopped, it was not the motor that took so long.
  [[nodiscard]] bool late(std::int64_t now_ns) const noexcept {
    return !confirmed() && told_ >= enough_times && now_ns - first_told_ns_ > off_within_ns;
  }

  int enough_reports_ = 3;
  std::int64_t told_ = 0, first_told_ns_ = 0, last_told_ns_ = 0;
  std::int64_t off_reports_ = 0, on_reports_ = 0;
};

}  // namespace tactus::devices
