// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cstdint>

namespace tactus::control {

/// Whether both sites live in the same time. Each sends a packet a tick, so while they follow one another the other's
/// numbers go by as fast as the own ticks. What is beyond a tolerated share adds up, each way apart (a CUSUM: E. S.
/// Page, Biometrika 41, 1954), and more than the slack means that the sites are out of pace:
///
///     behind ← max(0, behind + (ticks − numbers) − tolerance·ticks)
///     ahead  ← max(0, ahead  + (numbers − ticks) − tolerance·ticks)
///
/// The slack is for what may be on its way or lost at the end, the tolerance for ticks that the other may miss and for
/// crystals, which differ by 1e-4 at most. A clock that runs at the share 1 − m shows after slack/(m − tolerance),
/// however long it was right before. Both sites have the same rate, so one of them filters, derives and counts in
/// a wrong time. Lost packets do not matter.
class PaceCheck {
 public:
  struct Params {
    double slack_s = 0.3;
    double tolerance_share = 0.25;
    static constexpr auto fields() {
      return List{field("slack_s", &Params::slack_s, units::second, positive_up_to(30.0),
                        "Lag that proves nothing: the oldest packet that counts and the longest silence together."),
                  field("tolerance_share", &Params::tolerance_share, units::none, positive_up_to(0.9),
                        "Difference of the rates that proves nothing; above the share of control cycles that the other "
                        "site may miss.")};
    }
  };
  struct Input {
    bool following = false;
    std::int64_t sequence = 0;       ///< of the other site's newest packet
    std::int64_t elapsed_ticks = 1;  ///< own ones, since the step before
  };
  /// Whether the sites are out of pace.
  using Output = bool;

  static Result<PaceCheck> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return PaceCheck(params.slack_s / dt.value, params.tolerance_share);
  }

  /// Real-time safe.
  bool step(const Input& input) noexcept {
    if (!input.following || !followed_) {
      reset();
      followed_ = input.following;
      sequence_ = input.sequence;
      return false;
    }
    const double ticks = static_cast<double>(input.elapsed_ticks);
    const double late = ticks - (static_cast<double>(input.sequence) - static_cast<double>(sequence_));
    sequence_ = input.sequence;
    behind_ticks_ = std::max(0.0, behind_ticks_ + late - tolerance_share_ * ticks);
    ahead_ticks_ = std::max(0.0, ahead_ticks_ - late - tolerance_share_ * ticks);
    return std::max(behind_ticks_, ahead_ticks_) > slack_ticks_;
  }
  /// As if following began with the next step.
  void reset() noexcept {
    followed_ = false;
    sequence_ = 0;
    behind_ticks_ = ahead_ticks_ = 0.0;
  }

 private:
  PaceCheck(double slack_ticks, double tolerance_share)
      : slack_ticks_(slack_ticks), tolerance_share_(tolerance_share) {}

  double slack_ticks_;
  double tolerance_share_;
  bool followed_ = false;
  std::int64_t sequence_ = 0;  ///< of the step before
  double behind_ticks_ = 0.0;
  double ahead_ticks_ = 0.0;
};

}  // namespace tactus::control
