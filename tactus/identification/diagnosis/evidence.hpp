// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/diagnosis/oscillation.hpp>
#include <tactus/identification/diagnosis/own_wall.hpp>
#include <tactus/identification/diagnosis/signals.hpp>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace tactus::diagnosis {

/// What the signals show of one oscillation. Each is empty where its signals were not recorded.
struct Evidence {
  /// Amplitudes of the line, the median over the blocks. [m or rad, N or N m]
  std::array<std::optional<double>, role_count> amplitude = {};
  /// The master's part: amplitude of its scaled position over that of the slave's.
  std::optional<double> master_part;
  /// 0 to 1: whether the slave keeps a phase to a master that moves by more than its own steps: it may follow it.
  std::optional<double> follows;
  /// By which phase the slave comes after the scaled master, -pi to pi, where they keep one. [rad]
  std::optional<double> slave_behind_rad;
  /// Peak to peak within a period, in steps of the position's own column; the median over the blocks.
  std::optional<double> master_steps, slave_steps;
  /// Turns to and fro in a period, one each way: the smaller number of steps up and down of the position's own column.
  std::optional<double> master_turns, slave_turns;
  /// Share of the time in which the slave is at rest: slower than a tenth of what it reaches.
  std::optional<double> standstill;
  /// -1 to 1: how well a force is in line with the velocity of what it drives; positive: it gives energy at this
  /// frequency. Of the master's actuator on the master, of the hand on the master, of the slave's actuator on the
  /// slave.
  std::optional<double> actuator_gives, hand_gives, drive_gives;
  /// 0 to 1: tip force over the force of the slave's motor at this frequency (where that is missing, over ten steps of
  /// the sensor), coherence with the motion counted in.
  std::optional<double> contact;
  /// The same of the force of the environment on the slave; positive: whatever is at the slave's tip moves it, as no
  /// contact at rest can.
  std::optional<double> tip_gives;
  /// Transport delay to the slave and back, where a coupling by position explains the force.
  std::optional<double> delay_there_s, delay_back_s;
  /// Share of the displayed force's variance that a coupling by position explains, and that the tip force of some time
  /// before explains.
  std::optional<double> coupling_explains, tip_explains;
  /// Whether the displayed force is computed from the master's own position.
  std::optional<OwnWall> own_wall;
  /// 0 to 1: share of the master's power above half of the frequency that is in the line; the median over stretches of
  /// six periods.
  std::optional<double> master_line;
  /// The largest such share of a position or of the following error, of those that move by half a count or more.
  double line_of_motion = 0;
  /// Speed of the master's slower motion after the oscillation, the median, over that during it, the root mean square.
  /// Empty where it lasts until a second before the end of the recording.
  std::optional<double> motion_after;
  /// How much the size of the line wanders: standard deviation of its envelope over its mean, its trend taken off.
  double wander = 0;

  [[nodiscard]] const std::optional<double>& of(Role role) const { return amplitude[static_cast<std::size_t>(role)]; }
};

/// Measures it. Phases and powers come from blocks of a few periods each, averaged as cross spectra. Not real-time
/// safe.
Evidence measure(const Signals& signals, const Oscillation& oscillation);

/// A force that couples one position to another a delay ago, F = k·e + b·ė + constant, e = lead(t − delay) − own(t),
/// fitted where the force is not at its limits.
struct Coupling {
  double delay_s = 0;
  double explained = 0;  ///< share of the force's variance
};
/// The shortest delay of 0 to `longest_s` that explains the force within 2 % of the best. Looks at 20,000 samples at
/// most.
Coupling fit_coupling(std::span<const double> force, std::span<const double> lead, std::span<const double> own,
                      double longest_s, Seconds dt);

/// Share of the variance of a force that another one of 0 to `longest_s` before explains in proportion, both less what
/// is slower than half of the frequency, where the first is not at its limits. Not real-time safe.
double explained_by_force(std::span<const double> force, std::span<const double> cause, double frequency_Hz,
                          double longest_s, Seconds dt);

}  // namespace tactus::diagnosis
