// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/joints.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// The messages of the live view alongside the full-rate records.
namespace tactus::live {

/// What a loop of two arms is about in a tick, of links and tools; vectors along the axes of the base.
struct ArmsTick {
  std::uint64_t joints = 0;  ///< of each arm; none where the loop has no arms
  std::array<float, most_joints> leader_rad{};
  std::array<float, most_joints> follower_rad{};
  std::array<float, 3> hand_m{};             ///< where the operator means the leader's tool to be
  std::array<float, 3> displayed_force_N{};  ///< of the leader's motors alongside its support, at its tool
  std::array<float, 3> contact_force_N{};    ///< of the wall on the follower's tool
  std::array<float, 3> induced_m{};          ///< motion of the leader's tool that its site takes from the command
};

/// What one loop did in one tick.
struct LoopTick {
  std::uint64_t time_ns = 0;
  simulation::Teleoperator::Record record;
  ArmsTick arms;
  double hand_position_m = 0.0;     ///< where the visitor, or the script, wants the hand
  double hand_speed_m_per_s = 0.0;  ///< of the path that the hand means to take
  double wall_position_m = 0.0;     ///< as the master's hand sees it
  double real_time_ratio = 0.0;     ///< virtual time over real time, over the last second
  std::uint32_t number = 0;         ///< of the ticks of this loop, from 0
  std::uint32_t run = 0;            ///< grows each time the loop starts over
  std::uint32_t changes = 0;        ///< grows each time that parts of it were exchanged
  bool stopped = false;             ///< a safety gate latched, or a device left its workspace
};

/// The signals of a block, each with its place in a tick.
struct BlockSignal {
  const char* name;
  double (*value)(const LoopTick& tick);
  const char* doc;
};
inline constexpr std::array block_signals{
    BlockSignal{"master_position_m", [](const LoopTick& tick) { return tick.record.master_position_m; },
                "Measured, at the master's motor, toward the environment."},
    BlockSignal{"slave_position_m", [](const LoopTick& tick) { return tick.record.slave_position_m; },
                "Measured, at the slave's motor, toward the environment."},
    BlockSignal{"intended_motion_m",
                [](const LoopTick& tick) { return tick.record.master_position_m - tick.record.induced_position_m; },
                "Measured master position less the induced motion."},
    BlockSignal{"induced_motion_m", [](const LoopTick& tick) { return tick.record.induced_position_m; },
                "The model's estimate of what the displayed force did to the master."},
    BlockSignal{"command_m", [](const LoopTick& tick) { return tick.record.command_m; },
                "Position command that left the master."},
    BlockSignal{"slave_force_N", [](const LoopTick& tick) { return tick.record.contact_force_N; },
                "True force on the slave's tip, positive where the wall is pressed."},
    BlockSignal{"displayed_force_N", [](const LoopTick& tick) { return tick.record.displayed_force_N; },
                "Force at the master's motor, positive where it pushes the hand back."},
    BlockSignal{"hand_force_N", [](const LoopTick& tick) { return tick.record.hand_force_N; },
                "Measured force of the hand on the handle, toward the environment."}};

/// A number of columns, each with the least and the largest value of every signal over its ticks.
std::string live_block_definition();
/// The force of the hand at every tick.
std::string hand_force_definition();
std::string live_state_definition();
/// Of `ArmsTick`.
std::string live_arms_definition();

/// Gathers ticks of one loop and turns them into `LiveBlock` and `HandForce` messages.
class BlockBuilder {
 public:
  static constexpr std::size_t columns = 5;
  static constexpr double column_s = 0.004;

  explicit BlockBuilder(double tick_s);

  /// True where the tick completed a block, which `take` then must fetch.
  bool add(const LoopTick& tick);
  struct Block {
    std::uint64_t time_ns;  ///< of its first tick
    std::string live_block;
    std::string hand_force;
  };
  Block take();

 private:
  double tick_s_;
  std::size_t column_ticks_;
  std::size_t ticks_ = 0;
  std::uint64_t start_ns_ = 0;
  double start_s_ = 0.0;
  std::array<std::vector<float>, block_signals.size()> least_, largest_;
  std::vector<float> hand_force_N_;
};

/// What a page shows of a loop as numbers and words.
struct LiveState {
  double time_s = 0.0;
  double hand_position_m = 0.0;
  double master_position_m = 0.0;
  double slave_position_m = 0.0;
  double wall_position_m = 0.0;
  double slave_force_N = 0.0;
  double displayed_force_N = 0.0;
  double vibration_energy_J = 0.0;  ///< of `VibrationEnergy`, since the contact began
  bool in_contact = false;
  std::string verdict;
  std::string cause;
  std::string advice;
  double estimated_grip = 1.0;            ///< of the hand, over the one that the controller's model has
  double estimated_grip_deviation = 0.0;  ///< standard deviation of that; 0 where nothing is estimated
  double force_limit_N = 0.0;             ///< most that the master's motor displays
  double real_time_ratio = 0.0;
  std::uint64_t dropped = 0;  ///< ticks of this loop that the view lost
};
std::string to_cdr(const LiveState& state);
std::string to_cdr(const ArmsTick& arms, double time_s);

}  // namespace tactus::live
