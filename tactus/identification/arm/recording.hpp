// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <filesystem>
#include <string>
#include <vector>

/// What recordings determine of a whole arm.
namespace tactus::arm_identification {

/// Which columns of a recording are what: choices as `recording::read_columns` takes them.
struct ArmColumns {
  std::string time = {};
  std::string time_unit = {};  ///< s, ms, us or ns, instead of what the file states; empty: as the file states
  std::string position = {};
  std::string velocity = {};  ///< empty: from the positions
  std::string effort = {};    ///< torques or motor currents
};

/// A recording of an arm at equal time steps, by joint and sample.
struct ArmRecording {
  std::filesystem::path file = {};
  std::vector<std::string> position_names = {};
  std::vector<std::string> effort_names = {};
  /// `N m` of torques, of joints that slide too; else as the file has it, empty for no unit or several.
  std::string effort_unit = {};
  double start_s = 0.0;                            ///< what the file states of the first sample
  Seconds sample_time{0.0};                        ///< mean over the file
  std::vector<std::vector<double>> position = {};  ///< [rad], m of joints that slide
  std::vector<std::vector<double>> velocity = {};  ///< [rad/s]; empty if the file has no velocity
  std::vector<std::vector<double>> effort = {};    ///< [N m], N of joints that slide; currents as in the file

  [[nodiscard]] std::size_t joints() const { return position.size(); }
  [[nodiscard]] std::size_t samples() const { return position.empty() ? 0 : position.front().size(); }
};

/// Reads an arm of as many joints as there are `joints`, their names, for errors.
///
/// Times need not lie on a grid, since computers stamp samples when they come to it: values are interpolated linearly
/// onto one with the mean step. Positions may be in rad or deg (m or mm), velocities in the same a second.
///
/// Errors: those of `recording::read_columns`; `inconsistent` for another number of columns than of joints, for columns
/// of different length, for times that do not increase or that contradict the measured velocities by a thousand, and
/// for a pause longer than ten steps and 30 ms; `out_of_bounds` for times in which no arm is recorded; `wrong_type` for
/// a unit that fits no position or velocity. Not real-time safe.
Result<ArmRecording> read_arm(const std::filesystem::path& file, const ArmColumns& columns,
                              const std::vector<std::string>& joints);

/// A pause of so long is bridged, whatever the sampling.
inline constexpr double longest_pause_s = 0.03;

/// A joint as its drive reported it, each value at a time of its own; times rise.
struct ToldJoint {
  std::vector<double> time_s = {};
  std::vector<double> position = {};  ///< rad, m of one that slides
  std::vector<double> velocity = {};  ///< the same a second
  std::vector<double> effort = {};    ///< N m, N of one that slides
};

/// Drives that did not report at the same time, as a recording at equal steps: what all of them reported, on straight
/// lines between samples. `names` and `joints` go together. Errors: `inconsistent` for joints that have less than two
/// samples in common, or that report nothing for longer than ten steps and 30 ms. Not real-time safe.
Result<ArmRecording> recording_of(const std::filesystem::path& file, const std::vector<ToldJoint>& joints,
                                  const std::vector<std::string>& names, Seconds sample_time);

}  // namespace tactus::arm_identification
