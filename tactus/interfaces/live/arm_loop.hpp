// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/loops.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <cstddef>
#include <string>

namespace tactus::live {

/// Two arms, the leader in the visitor's hand, in virtual time. The record is along the wall's normal, from where the
/// tools began: positions are the tools', the follower's over the pair's `tool_scale`; the displayed force is what the
/// leader's motors alongside its support come to at its tool; the peak of the contact is its mean over a tick.
class ArmLoop final : public Loop {
 public:
  using Setup = experiments::ArmPairSetup;
  using Parts = experiments::ArmPair::Parts;

  /// Gives `parts` where another continues with it. Errors: those of `ArmPair::make`.
  static Result<std::unique_ptr<Loop>> make(const Setup& setup, const Parts& parts = {});
  /// As `change_loop`; of setups that differ in their `params` alone. It always continues.
  static Result<LoopChange> change(const Setup& before, const Setup& after);

  void step(const HandPoint& path, const HandPoint& path_at_next_tick, double share, LoopTick& tick) noexcept override;
  [[nodiscard]] bool good() const noexcept override { return inside_ && pair_.healthy(); }
  [[nodiscard]] bool at_rest() const noexcept override { return pair_.at_rest(); }
  [[nodiscard]] double tick_s() const noexcept override { return pair_.tick_s(); }
  void exchange(Loop& made) noexcept override;

 private:
  ArmLoop(experiments::ArmPair pair, const arm::Matrix3& directions, const Parts& parts);
  /// Where the operator is, of a hand that is there at this time since the loop began.
  [[nodiscard]] arm::Vector3 path_m(const HandPoint& hand, double time_s) const;

  experiments::ArmPair pair_;
  arm::Matrix3 directions_;
  Parts parts_;
  std::size_t ticks_ = 0;
  HandPoint joined_at_{};  ///< where the hand was in the first tick
  bool inside_ = true;
};

/// The directions of the hand along the axes of the base, a column each: toward the wall, and two across.
arm::Matrix3 hand_directions(const experiments::ArmPairSetup& setup);

/// What a page needs to draw the arms, as JSON: for `leader` and `follower` the joints (`name`, and of its frame in
/// that of the joint before, at position 0, `origin_m` and `rotation`, row after row; `axis` in its own frame;
/// `slides`), the tool's point `tool_m` in the frame of the last and `start_rad`; `wall_m`, from where the follower's
/// tool begins; `directions`, of the hand and so of the wall, along the axes of both bases.
std::string arms_as_json(const experiments::ArmPairSetup& setup);

}  // namespace tactus::live
