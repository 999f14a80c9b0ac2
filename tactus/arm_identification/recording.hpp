#pragma once

#include <tactus/core/result.hpp>
#include <tactus/core/units.hpp>

#include <filesystem>
#include <string>
#include <vector>

/// What recordings tell of a whole arm.
namespace tactus::arm_identification {

/// Which columns of a recording are what: choices as `recording::read_columns` takes them.
struct ArmColumns {
  std::string time = {};
  std::string position = {};
  std::string velocity = {};  ///< empty: from the positions
  std::string effort = {};    ///< torques or motor currents
};

/// A recording of an arm at equal time steps, by joint and sample.
struct ArmRecording {
  std::filesystem::path file = {};
  std::vector<std::string> position_names = {};
  std::vector<std::string> effort_names = {};
  std::string effort_unit = {};                    ///< as the file has it, of the first joint; empty where it has none
  double start_s = 0.0;                            ///< what the file says of the first sample
  Seconds sample_time{0.0};                        ///< mean over the file
  std::vector<std::vector<double>> position = {};  ///< [rad], m of joints that slide
  std::vector<std::vector<double>> velocity = {};  ///< [rad/s]; empty where the file has none
  std::vector<std::vector<double>> effort = {};    ///< [as in the file]

  [[nodiscard]] std::size_t joints() const { return position.size(); }
  [[nodiscard]] std::size_t samples() const { return position.empty() ? 0 : position.front().size(); }
};

/// Reads an arm of as many joints as there are `joints`, their names, for errors.
///
/// Times need not lie on a grid, since computers stamp samples when they come to it: values are interpolated linearly
/// onto one with the mean step. Positions may be in rad or deg (m or mm), velocities in the same a second.
///
/// Errors: those of `recording::read_columns`; `inconsistent` for another number of columns than of joints, for columns
/// of different length, for times that do not increase, and for a pause longer than ten steps and 30 ms; `wrong_type`
/// for a unit that fits no position or velocity. Not real-time safe.
Result<ArmRecording> read_arm(const std::filesystem::path& file, const ArmColumns& columns,
                              const std::vector<std::string>& joints);

}  // namespace tactus::arm_identification
