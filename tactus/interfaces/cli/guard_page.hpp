// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>

namespace tactus::cli {

/// What a program that drives motors and the guard process of these motors exchange, in memory that both map.
/// Each counter has one writer. Real-time safe.
struct GuardPage {
  std::atomic<std::uint64_t> program_beats{0};  ///< counts while the servo thread ticks and the bus ends cycles
  std::atomic<std::uint64_t> guard_beats{0};    ///< counts while the guard looks
  std::atomic<std::uint64_t> powered{0};        ///< 1: the program wants power, or a motor reports that it has power
  std::atomic<std::uint64_t> taken{0};          ///< how often the guard has switched the motors off
  std::atomic<std::uint64_t> acknowledged{0};   ///< the `taken` that the program has answered by wanting no power
  std::atomic<std::uint64_t> guard_ended{0};    ///< 1: the program has seen the end of the guard process
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

/// Owns the mapping of a page.
class MappedGuardPage {
 public:
  /// A new page, all zeros. None where the system gives no memory; errno states why.
  static std::optional<MappedGuardPage> create();
  /// The page of another process; takes the descriptor. None where it is not one.
  static std::optional<MappedGuardPage> adopt(int descriptor);
  MappedGuardPage(MappedGuardPage&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), page_(std::exchange(other.page_, nullptr)) {}
  MappedGuardPage& operator=(MappedGuardPage&&) = delete;
  ~MappedGuardPage();

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] GuardPage& operator*() const noexcept { return *page_; }
  [[nodiscard]] GuardPage* operator->() const noexcept { return page_; }

 private:
  explicit MappedGuardPage(int descriptor) : descriptor_(descriptor) {}
  bool map();

  int descriptor_;
  GuardPage* page_ = nullptr;
};

/// How often the guard looks.
inline constexpr std::int64_t guard_look_ns = 5'000'000;
/// The guard switches the motors off when the program has not beaten for this time. It is four times as long as the
/// bus thread waits for a command (50 ms), so a program that still runs has switched its motors off before.
inline constexpr std::int64_t program_timeout_ns = 200'000'000;
/// The program releases when the guard has not beaten for this time. A guard that has ended is noticed sooner.
inline constexpr std::int64_t guard_timeout_ns = 500'000'000;

/// Judges whether another process still counts its beats. Time is added up over the looks, each for at most
/// `longest_look_ns`: if the machine stops both processes, the time of the stop does not count against the other one.
class BeatWatch {
 public:
  BeatWatch(std::int64_t timeout_ns, std::int64_t longest_look_ns) noexcept
      : timeout_ns_(timeout_ns), longest_look_ns_(longest_look_ns) {}
  /// False when the beats have not changed for the timeout. Times never go back. Real-time safe.
  bool alive(std::uint64_t beats, std::int64_t now_ns) noexcept {
    const std::int64_t passed_ns = looked_ ? std::min(now_ns - last_ns_, longest_look_ns_) : 0;
    waited_ns_ = looked_ && beats == beats_ ? waited_ns_ + passed_ns : 0;
    beats_ = beats;
    last_ns_ = now_ns;
    looked_ = true;
    return waited_ns_ < timeout_ns_;
  }
  /// The wait starts again at the next look.
  void restart() noexcept { looked_ = false; }

 private:
  std::int64_t timeout_ns_, longest_look_ns_;
  std::int64_t last_ns_ = 0, waited_ns_ = 0;
  std::uint64_t beats_ = 0;
  bool looked_ = false;
};

}  // namespace tactus::cli
