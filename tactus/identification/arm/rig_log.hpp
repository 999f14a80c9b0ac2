// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/recording.hpp>
#include <tactus/kernel/core/result.hpp>

#include <string>
#include <vector>

/// What a log of two coupled arms contains of one that moves freely.
namespace tactus::arm_identification {

/// Whether it is read as a log: a folder, or a file that ends in `.mcap`.
bool is_log(const std::string& file);

/// The follower of a log that `tactus run --realtime --device RIG --out` left, while it followed: for each stretch of
/// 1 s or more in which the site was active and every drive was received at least each 30 ms, where its drives were,
/// how fast, as they reported it and when they did (`position_age_s`), and with which mean torque since their last
/// report. The leader is left out: what the hand does to it is no drive's torque, so it does not move freely. Of a ROS
/// 2 bag all of its arm (`read_bag_arm`).
///
/// `joints` are names of joints of the rig, in the order of the arm; the rig may have more. Errors: those of
/// `telemetry::read_log`; `missing` for a log of something else, for one from before the drives' words were logged, and
/// for one without such a stretch; `inconsistent` for a joint that the rig has not. Not real-time safe.
Result<std::vector<ArmRecording>> read_rig_log(const std::string& file, const std::vector<std::string>& joints);

}  // namespace tactus::arm_identification
