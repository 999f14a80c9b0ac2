// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <vector>

/// What the energy tests of the delayed architectures drive the sites with: lines that delay, reorder and lose, and
/// motions that nobody chose to be kind.
namespace tactus::control {

/// Uniform numbers that are the same on every platform.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double between(double lower, double upper) {
    return lower + (upper - lower) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  bool happens(double probability) { return between(0.0, 1.0) < probability; }

 private:
  std::mt19937_64 engine_;
};

/// One way of a datagram line, written apart from `station::Channel`: messages in a bag, each with its due tick.
/// The newest that is due counts; an older one that comes later is dropped.
class RandomLine {
 public:
  RandomLine(Draw& draw, int delay, int jitter, double loss)
      : draw_(&draw), delay_(delay), jitter_(jitter), loss_(loss) {}

  /// A line of any delay up to 300 ticks, in one case of four without any trouble.
  static RandomLine any(Draw& draw) {
    const auto delay = static_cast<int>(draw.between(0.0, 300.0) * (draw.happens(0.3) ? 0.0 : 1.0));
    if (draw.happens(0.25)) return {draw, delay, 0, 0.0};
    return {draw, delay, static_cast<int>(draw.between(0.0, 60.0)), draw.between(0.0, 0.7)};
  }

  Arrival step(const Message& message) {
    ++now_;
    const int due = now_ + delay_ + static_cast<int>(draw_->between(0.0, jitter_ + 1.0));
    if (!draw_->happens(loss_)) bag_.insert({due, {now_, message}});
    newest_.fresh = false;
    for (auto it = bag_.begin(); it != bag_.end() && it->first <= now_; it = bag_.erase(it)) {
      if (it->second.number <= number_) continue;
      number_ = it->second.number;
      newest_ = {.message = it->second.message, .fresh = true};
    }
    return newest_;
  }

 private:
  struct Sent {
    int number;
    Message message;
  };
  Draw* draw_;
  int delay_, jitter_;
  double loss_;
  int now_ = 0;
  int number_ = 0;
  std::multimap<int, Sent> bag_;
  Arrival newest_;
};

/// A motion that never exceeds `fastest_m_per_tick`: smooth, or a new direction at every tick.
class RandomMotion {
 public:
  RandomMotion(Draw& draw, double fastest_m_per_tick, bool smooth)
      : draw_(&draw), fastest_m_per_tick_(fastest_m_per_tick), smooth_(smooth) {
    for (Wave& wave : waves_) {
      wave = {draw.between(0.001, 0.02), draw.between(0.0, 2.0 * std::numbers::pi)};
    }
  }
  double step() {
    ++now_;
    double share = 0.0;
    if (smooth_) {
      for (const Wave& wave : waves_) share += std::sin(wave.per_tick * now_ + wave.phase) / 3.0;
    } else {
      share = draw_->between(-1.0, 1.0);
    }
    return position_m_ += fastest_m_per_tick_ * share;
  }

 private:
  struct Wave {
    double per_tick, phase;
  };
  Draw* draw_;
  double fastest_m_per_tick_;
  bool smooth_;
  std::array<Wave, 3> waves_{};
  int now_ = 0;
  double position_m_ = 0.0;
};

}  // namespace tactus::control
