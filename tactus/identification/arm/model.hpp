// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace tactus::arm_identification {

/// One joint of an identified arm.
struct ArmJointModel {
  std::string name = {};
  double effort_per_N_m = 1.0;
  double residual_rms_N_m = 0.0;
  double contact_threshold_N_m = 0.0;
  arm::JointParams arm = {};
  static constexpr auto fields() {
    using J = ArmJointModel;
    return List{field("name", &J::name, "The joint, as the URDF calls it."),
                field("effort_per_N_m", &J::effort_per_N_m, units::none, positive,
                      "What the effort reads for a torque of 1 N m: 1 where it is a torque, else amperes or steps."),
                field("residual_rms_N_m", &J::residual_rms_N_m, arm::units::newton_metre, non_negative,
                      "What the model leaves of the torque in free motion, rms below the cutoff."),
                field("contact_threshold_N_m", &J::contact_threshold_N_m, arm::units::newton_metre, non_negative,
                      "What it never left in free motion: an external torque above it is a contact."),
                field("arm", &J::arm, "Joint and link.")};
  }
};

/// What is known of the whole arm.
struct ArmModelHead {
  std::int64_t joints = 1;
  double cutoff_Hz = 10.0;
  arm::Gravity gravity = {};
  static constexpr auto fields() {
    using H = ArmModelHead;
    return List{field("joints", &H::joints, between(1, static_cast<double>(most_joints)), "Number of joints."),
                field("cutoff_Hz", &H::cutoff_Hz, units::hertz, positive,
                      "Cutoff of the zero-phase filter with which the model was found, and is used."),
                field("gravity", &H::gravity, "Free fall in the frame of the base.")};
  }
};

/// An identified arm as a file holds it: `model.toml` of `tactus identify arm`.
struct ArmModel {
  ArmModelHead head = {};
  Joints<ArmJointModel> joints = {};

  [[nodiscard]] arm::Chain::Params chain() const;
};

/// As TOML below `comment`: a section for each joint, `joint_1` and on.
std::string to_toml(const ArmModel& model, std::string_view comment);
/// Errors: those of `Document` and of `arm::Chain::make`, with their places. Not real-time safe.
Result<ArmModel> load_arm_model(const std::filesystem::path& file);

}  // namespace tactus::arm_identification
