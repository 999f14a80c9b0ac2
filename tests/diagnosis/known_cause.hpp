// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Recordings of simulated teleoperators that shake for a reason that is known, or do not shake. They share no code
/// with what diagnoses them.
namespace tactus::known {

/// Why it shakes. The words are those of a diagnosis.
enum class Cause { induced_motion, slave_servo, delay, quantisation, stick_slip, tremor };
inline constexpr std::array<std::string_view, 6> words{"induced-motion", "slave-servo", "delay",
                                                       "quantisation",   "stick-slip",  "tremor"};

/// How far beyond the onset of the oscillation.
enum class Strength {
  quiet,  ///< a third to six tenths of the way to it: no oscillation
  near,   ///< up to 20 % beyond
  clear,  ///< 30 to 150 % beyond
};

/// A sample of what a user would record, at 1 kHz.
struct Row {
  double time_s, master_m, slave_m, displayed_N, tip_N, hand_N, drive_N;
};

struct Recording {
  std::vector<Row> rows;
  bool with_hand_force = false;
  double strength = 0;    ///< of what makes it shake, over its onset
  std::string parameter;  ///< what that is
  double onset = 0;       ///< its value there
};

/// The recording of this seed. A rig is drawn, what makes it shake is raised until it does, and it is taken to the
/// strength asked for; then the reason is taken away from the same rig, which must end the oscillation. A rig that does
/// neither is drawn again.
Result<Recording> make(Cause cause, Strength strength, std::uint64_t seed);

/// As a table with the header that `tactus diagnose` reads without options.
std::string to_csv(const Recording& recording);

}  // namespace tactus::known
