// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cstdint>

namespace tactus::cli {

/// What a datagram network does to one message after the other, drawn from a seed: whether it is lost, and how much of
/// the jitter it takes. The relay draws from it.
///
/// Losses come alone, each drawn for itself, or in bursts of a given mean length (Gilbert 1960): a state that loses all
/// and is left with probability 1/burst, and one that loses none and is left so often that the share comes out.
/// Real-time safe.
class Passages {
 public:
  struct Passage {
    bool lost = false;
    double jitter_share = 0.0;  ///< in [0, 1)
  };

  /// `mean_burst` of at most 1 draws each loss for itself. The share of losses in bursts is at most burst/(burst + 1).
  Passages(double loss_fraction, double mean_burst, bool jitters, std::int64_t seed) noexcept
      : loss_fraction_(loss_fraction), jitters_(jitters), random_(static_cast<std::uint64_t>(seed)) {
    if (mean_burst <= 1.0 || loss_fraction >= 1.0) return;
    in_bursts_ = true;
    leave_ = 1.0 / mean_burst;
    enter_ = std::min(1.0, loss_fraction / (1.0 - loss_fraction) * leave_);
  }

  Passage next() noexcept {
    Passage passage;
    if (loss_fraction_ > 0.0) {
      const double draw = random_.uniform();
      if (in_bursts_) {
        losing_ = losing_ ? draw >= leave_ : draw < enter_;
        passage.lost = losing_;
      } else {
        passage.lost = draw < loss_fraction_;
      }
    }
    if (jitters_) passage.jitter_share = random_.uniform();
    return passage;
  }

 private:
  double loss_fraction_;
  bool jitters_;
  signal::Random random_;
  bool in_bursts_ = false;
  double leave_ = 1.0;
  double enter_ = 0.0;
  bool losing_ = false;
};

}  // namespace tactus::cli
