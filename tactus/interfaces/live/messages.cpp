// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/description.hpp>
#include <tactus/interfaces/live/cdr_writer.hpp>
#include <tactus/interfaces/live/messages.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::live {

namespace {

std::string line(const std::string& type, const std::string& name, const std::string& doc) {
  const Unit unit = unit_at_end_of(name);
  const std::string with_unit = unit.symbol[0] == '\0' ? doc : doc + " Unit: " + unit.symbol + ".";
  return "# " + with_unit + "\n" + type + " " + telemetry::ros_name(name) + "\n";
}

}  // namespace

std::string live_block_definition() {
  std::string text = line("float64", "start_s", "Virtual time of the first control cycle.") +
                     line("float64", "column_s", "Duration of a column.");
  for (const BlockSignal& signal : block_signals) {
    const std::string name = telemetry::ros_name(signal.name);
    text += "# " + std::string(signal.doc) + " Unit: " + unit_at_end_of(signal.name).symbol +
            ". The least and the largest value of each column.\n";
    text += "float32[] " + name + "_min\nfloat32[] " + name + "_max\n";
  }
  return text;
}

std::string hand_force_definition() {
  return line("float64", "start_s", "Virtual time of the first control cycle.") +
         line("float64", "period_s", "From control cycle to control cycle.") +
         line("float32[]", "force_N",
              "Measured force of the hand on the handle in each control cycle, toward the environment.");
}

std::string live_state_definition() {
  return line("float64", "time_s", "Virtual time of the control cycle.") +
         line("float64", "hand_position_m", "Where the visitor, or the script, wants the hand.") +
         line("float64", "master_position_m", "Measured, at the master's motor.") +
         line("float64", "slave_position_m", "Measured, at the slave's motor.") +
         line("float64", "wall_position_m", "The wall's surface, over the position scale.") +
         line("float64", "slave_force_N", "True force on the slave's tip.") +
         line("float64", "displayed_force_N", "At the master's motor, positive where it pushes the hand back.") +
         line("float64", "vibration_energy_J",
              "That the master's motor gave to the handle by vibration above 15 Hz, since the contact began.") +
         line("bool", "in_contact", "The slave touches the wall.") +
         line("string", "verdict", "free, contact, settled, rings or stopped.") +
         line("string", "cause", "Why, in one sentence; may be empty.") +
         line("string", "advice", "What the verdict means for the loop, and what to try; may be empty.") +
         line("float64", "force_limit_N", "The most that is displayed at the master's motor.") +
         line("float64", "real_time_ratio", "Virtual time over real time, over the last second.") +
         line("uint64", "dropped", "Control cycles of this loop that the view has lost, since the start.") +
         line("float64", "estimated_grip", "How firmly the hand holds, over the controller's model of it.") +
         line("float64", "estimated_grip_deviation", "Standard deviation of that; 0 where nothing is estimated.");
}

std::string live_arms_definition() {
  return line("float64", "time_s", "Virtual time of the control cycle.") +
         line("float32[]", "leader_rad", "Of each joint's link, from the base on; metres where it slides.") +
         line("float32[]", "follower_rad", "The same of the follower.") +
         line("float32[]", "hand_m", "Where the operator aims the leader's tool, along the axes of the base.") +
         line("float32[]", "displayed_force_N",
              "Of the leader's motors without gravity compensation, at its tool, along the axes of the base.") +
         line("float32[]", "contact_force_N", "Of the wall on the follower's tool, along the axes of the base.") +
         line("float32[]", "induced_m", "Motion of the leader's tool that its site takes from the command.");
}

BlockBuilder::BlockBuilder(double tick_s)
    : tick_s_(tick_s), column_ticks_(static_cast<std::size_t>(std::max(1L, std::lround(column_s / tick_s)))) {}

bool BlockBuilder::add(const LoopTick& tick) {
  if (ticks_ == 0) {
    start_ns_ = tick.time_ns;
    start_s_ = tick.record.time_s;
  }
  const bool new_column = ticks_ % column_ticks_ == 0;
  for (std::size_t i = 0; i < block_signals.size(); ++i) {
    const auto value = static_cast<float>(block_signals[i].value(tick));
    if (new_column) {
      least_[i].push_back(value);
      largest_[i].push_back(value);
    } else {
      least_[i].back() = std::min(least_[i].back(), value);
      largest_[i].back() = std::max(largest_[i].back(), value);
    }
  }
  hand_force_N_.push_back(static_cast<float>(tick.record.hand_force_N));
  return ++ticks_ == columns * column_ticks_;
}

BlockBuilder::Block BlockBuilder::take() {
  CdrWriter block;
  block.add(start_s_);
  block.add(static_cast<double>(column_ticks_) * tick_s_);
  for (std::size_t i = 0; i < block_signals.size(); ++i) {
    block.add(std::span<const float>(least_[i]));
    block.add(std::span<const float>(largest_[i]));
    least_[i].clear();
    largest_[i].clear();
  }
  CdrWriter force;
  force.add(start_s_);
  force.add(tick_s_);
  force.add(std::span<const float>(hand_force_N_));
  hand_force_N_.clear();
  ticks_ = 0;
  return {.time_ns = start_ns_, .live_block = std::move(block).take(), .hand_force = std::move(force).take()};
}

std::string to_cdr(const LiveState& state) {
  CdrWriter writer;
  for (const double value :
       {state.time_s, state.hand_position_m, state.master_position_m, state.slave_position_m, state.wall_position_m,
        state.slave_force_N, state.displayed_force_N, state.vibration_energy_J}) {
    writer.add(value);
  }
  writer.add(state.in_contact);
  writer.add(std::string_view(state.verdict));
  writer.add(std::string_view(state.cause));
  writer.add(std::string_view(state.advice));
  writer.add(state.force_limit_N);
  writer.add(state.real_time_ratio);
  writer.add(state.dropped);
  writer.add(state.estimated_grip);
  writer.add(state.estimated_grip_deviation);
  return std::move(writer).take();
}

std::string to_cdr(const ArmsTick& arms, double time_s) {
  CdrWriter writer;
  writer.add(time_s);
  writer.add(std::span(arms.leader_rad).first(arms.joints));
  writer.add(std::span(arms.follower_rad).first(arms.joints));
  for (const auto* vector : {&arms.hand_m, &arms.displayed_force_N, &arms.contact_force_N, &arms.induced_m}) {
    writer.add(std::span<const float>(*vector));
  }
  return std::move(writer).take();
}

}  // namespace tactus::live
