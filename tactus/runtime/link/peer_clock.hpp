// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tactus::link {

/// The other host's clock as seen from here. From each echo follow the round trip and the offset, as in NTP (RFC 5905,
/// Sec. 8), with t1 own sending, t2 the other's receipt, t3 its answer and t4 own receipt:
///
///     round trip = (t4 − t1) − (t3 − t2)      offset = ((t2 − t1) + (t3 − t4)) / 2
///
/// The offset is that of the shortest round trip of the last one to two seconds: what waited least in queues errs
/// least. Its error is at most half of that round trip, and reaches it where one way takes all of the time: two clocks
/// cannot distinguish an asymmetric link from an offset. In two seconds, clocks that differ by 50 ppm drift by 0.1 ms.
/// Times in ns. Real-time safe.
class PeerClock {
 public:
  /// One echo: own datagram sent at `sent_ns` (own clock), answered by one that left at `answered_ns` (other's clock)
  /// after it was held for `held_ns`, and arrived at `now_ns` (own clock). Echoes that no clock could have made, a
  /// negative round trip or one over a minute, are ignored, and false is returned.
  bool observe(std::int64_t sent_ns, std::int64_t held_ns, std::int64_t answered_ns, std::int64_t now_ns) noexcept {
    // Unsigned, so that the numbers of a stranger cannot overflow.
    const auto difference = [](std::int64_t a, std::int64_t b) {
      return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
    };
    if (sent_ns > now_ns || held_ns > difference(now_ns, sent_ns)) return false;
    const std::int64_t round_trip_ns = difference(now_ns, sent_ns) - held_ns;
    if (round_trip_ns > longest_ns || answered_ns < held_ns) return false;
    round_trip_ns_ = round_trip_ns;
    // The answer left half a round trip before it arrived, on the own clock.
    const Sample sample{.round_trip_ns = round_trip_ns,
                        .offset_ns = difference(answered_ns, now_ns - round_trip_ns / 2)};
    if (!best_ || now_ns - bucket_started_ns_ >= bucket_ns) {
      previous_ = best_;
      best_ = sample;
      bucket_started_ns_ = now_ns;
    } else if (sample.round_trip_ns <= best_->round_trip_ns) {
      best_ = sample;
    }
    return true;
  }

  void reset() noexcept { *this = PeerClock(); }

  /// Whether anything is known yet.
  [[nodiscard]] bool known() const noexcept { return best_.has_value(); }
  /// Of the latest echo; 0 before the first.
  [[nodiscard]] std::int64_t round_trip_ns() const noexcept { return round_trip_ns_; }
  /// The other's clock less the own; 0 before the first echo.
  [[nodiscard]] std::int64_t offset_ns() const noexcept { return known() ? shortest().offset_ns : 0; }
  /// Bound of the offset's error.
  [[nodiscard]] std::int64_t offset_error_ns() const noexcept { return known() ? shortest().round_trip_ns / 2 : 0; }
  /// How long before `now_ns` (own clock) the instant `sent_ns` of the other's clock was; never negative.
  [[nodiscard]] std::int64_t age_ns(std::int64_t sent_ns, std::int64_t now_ns) const noexcept {
    const auto age =
        static_cast<std::int64_t>(static_cast<std::uint64_t>(now_ns) - static_cast<std::uint64_t>(sent_ns) +
                                  static_cast<std::uint64_t>(offset_ns()));
    return age > 0 ? age : 0;
  }

 private:
  static constexpr std::int64_t longest_ns = 60'000'000'000;
  static constexpr std::int64_t bucket_ns = 1'000'000'000;
  struct Sample {
    std::int64_t round_trip_ns;
    std::int64_t offset_ns;
  };
  [[nodiscard]] const Sample& shortest() const noexcept {
    return previous_ && previous_->round_trip_ns < best_->round_trip_ns ? *previous_ : *best_;
  }

  std::int64_t round_trip_ns_ = 0;
  std::int64_t bucket_started_ns_ = 0;
  std::optional<Sample> best_;      ///< of this bucket of time
  std::optional<Sample> previous_;  ///< of the one before
};

}  // namespace tactus::link
