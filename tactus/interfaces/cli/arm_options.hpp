// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/urdf/urdf.hpp>
#include <tactus/identification/arm/recording.hpp>
#include <tactus/interfaces/cli/output_folder.hpp>
#include <tactus/kernel/core/result.hpp>

#include <string>
#include <vector>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

/// What the commands that read recordings of an arm share.
namespace tactus::cli {

struct ArmOptions {
  std::vector<std::string> time, position, velocity, effort;
  std::string time_unit;
  OutputOptions output;

  /// An option that is given more than once names more columns.
  [[nodiscard]] arm_identification::ArmColumns columns() const;
};

/// Which arm, and how it hangs.
struct ArmUrdfOptions {
  std::string file;
  std::string tip;
  std::vector<std::string> gravity;   ///< three numbers, or the word `free` where the command takes it
  std::vector<std::string> reversed;  ///< joints that count the other way than the file states
  std::vector<double> payload;        ///< mass in kg, and its place in m in the frame of the last moving link

  [[nodiscard]] bool gravity_is_free() const { return gravity.size() == 1 && gravity.front() == "free"; }
};

/// The arm of the file, with gravity, reversed joints and payload as they were given. Errors: those of `urdf::read`,
/// and of `arm::Gravity`; `unknown_key` for a reversed joint that the arm does not have; `out_of_bounds` for a payload
/// of no mass.
Result<urdf::Arm> read_arm_urdf(const ArmUrdfOptions& options);
/// Adds `--urdf`, `--tip`, `--gravity`, `--reverse` and `--payload` to a command. `finds_gravity`: whether `--gravity
/// free` is one.
void add_arm_urdf_options(CLI::App& verb, ArmUrdfOptions& options, bool finds_gravity);

/// A recording with these columns, or the stretches of a log (`read_rig_log`), which names its own columns.
/// Errors: those of `arm_identification::read_arm` and `read_rig_log`; `missing` for a table without a role,
/// `inconsistent` for a log with one.
Result<std::vector<arm_identification::ArmRecording>> read_recordings(const std::string& file,
                                                                      const ArmOptions& options,
                                                                      const std::vector<std::string>& joints);

/// Adds the roles of columns, `--out` and `--json` to a command.
void add_arm_options(CLI::App& verb, ArmOptions& options, const std::string& command, const std::string& out_help);

}  // namespace tactus::cli
