// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/signal/random.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tactus::arm_plants {

/// What a host knows of an arm's drives, and since when.
struct KnownReading {
  ArmReading reading;
  JointVector at_s;  ///< when each drive read it
};

/// A simulated arm behind a bus that a host polls: at each tick of the host every drive gets a command, and answers
/// with what it reads then. The host works on answers of an earlier tick. Of a joint whose frames are lost the drive
/// continues by the law it has, and the host by the reading it has, as openarm_can does, without a report.
///
/// A value: a copy continues by itself. A tick does not allocate.
/// Source of the order in a tick: openarm_teleop (Apache-2.0), `bilateral_step`.
class PolledArm {
 public:
  struct Params {
    /// Control cycles from a command to the cycle that uses its reply: 1 where the host waits for the answers, 2 where
    /// its time for them ends before they come, more where an adapter holds them back. 1 to 1000.
    int answer_ticks = 1;
    /// Of each joint, the share of the ticks without its reply, 0 to below 1; empty for 0 everywhere.
    Joints<double> lost_share = {};
    /// Mean number of consecutive ticks without its reply. 1 or more.
    double outage_ticks = 1.0;
    std::uint64_t seed = 1;
  };

  /// The host knows the arm as it is at `now_s`. Errors: `out_of_bounds` for a number outside its range above, and
  /// for outages so short that the share cannot be reached (`outage_ticks` below share/(1 − share)); `inconsistent` for
  /// another number of shares than of joints.
  static Result<PolledArm> make(const Params& params, ArmPlant plant, double now_s);

  /// What the host works on in the tick that begins now.
  [[nodiscard]] const KnownReading& known() const noexcept { return known_; }
  /// The end of that tick, at `now_s`: commands go out and drives answer.
  void tick(const ArmCommand& command, double now_s);
  /// Whether that tick's frames of a joint (from 0) got through.
  [[nodiscard]] bool heard(int joint) const noexcept { return !silent_[static_cast<std::size_t>(joint)]; }
  /// One step of the arm.
  void step(const ToolForce& on_tool) { plant_.step(on_tool); }
  [[nodiscard]] const ArmPlant& plant() const noexcept { return plant_; }

 private:
  struct Answers {
    KnownReading told;
    Joints<bool> heard;
  };

  PolledArm(const Params& params, ArmPlant plant, double now_s, int joints);
  void take(const Answers& answers);

  ArmPlant plant_;
  Joints<double> lost_share_;
  double outage_ticks_;
  signal::Random random_;
  Joints<bool> silent_;
  ArmCommand acting_;
  KnownReading known_;
  std::vector<Answers> on_the_way_;  ///< a ring
  std::size_t next_ = 0;
};

}  // namespace tactus::arm_plants
