// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/recording.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tactus::identification {

/// Which columns of a recording are what. Whatever is not named is looked for.
///
/// A column is named as the file names it, in a MATLAB file with `:COLUMN` (from 1) after the variable:
/// `scope.signals(1).values:2`. Looked for are, by the unit in the header or else by common names, one position (m, mm,
/// rad, deg; `position`, `x`, `q`, `theta`, …) and one force (N, mN, kN, N m, mN m; `force`, `torque`, `tau`, …); of
/// several forces, the one of the actuator drives and the one of the environment is measured. A struct `scope` as an
/// xPC or Simulink scope writes it for a teleoperator, `signals(1..3).values` with the columns [master, slave] being
/// positions, interaction forces (of the hand on the master, on the environment) and actuator forces, is known too; its
/// second column is taken, for the force of the hand its first.
struct AxisRoles {
  std::filesystem::path file = {};
  bool of_the_hand = false;  ///< the axis is a master and its force that of the hand, of several positions the master's
  std::string position = {};
  std::string force = {};     ///< of the actuator, or of the hand
  std::string external = {};  ///< another force that drives the axis, such as a hand's; none unless named
  std::string measured = {};  ///< of the environment, to compare with
  std::string time = {};
  std::string time_unit = {};  ///< s, ms, us or ns, instead of what the file states; empty: as the file states
  std::optional<double> sample_time_s = {};
  std::optional<double> position_sign = {};  ///< 1 or -1
  std::optional<double> force_sign = {};     ///< 1 or -1
  std::optional<double> measured_sign = {};  ///< 1 or -1, so that it becomes the force on the axis
};

/// A column that was chosen, in N and m, or N m and rad, turned by its sign.
struct AxisColumn {
  std::string name = {};  ///< as `AxisRoles` names it
  double factor = 1;      ///< sign and unit
  std::vector<double> values = {};
};

struct AxisRecording {
  AxisColumn position;
  AxisColumn force;                    ///< of the actuator, the external one added; or of the hand
  std::optional<AxisColumn> measured;  ///< force of the environment on the axis
  Seconds sample_time{0.0};
  bool rotary = false;  ///< N m and rad instead of N and m
  /// What a reader of results should know of the recording: jitter of its times, columns that were not used.
  std::vector<std::string> notes = {};
};

/// Does a file hold the struct `scope` of a teleoperator that `AxisRoles` describes?
bool is_teleoperator_scope(const std::vector<recording::Entry>& entries);

/// Reads one axis. Errors: those of `recording::read`; `missing` when a role is neither named nor found, or found more
/// than once: the message lists the columns and the option to name one with; no sample time; columns of different
/// length; a unit that is not one of the above. `needs_measured`: the measured force is looked for too, but may be
/// absent. Not real-time safe.
Result<AxisRecording> read_axis(const AxisRoles& roles, bool needs_measured = false);

}  // namespace tactus::identification
