// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/core/joints.hpp>
#include <tactus/kernel/core/parameters.hpp>

namespace tactus::arm_control {

/// What a file states of each joint, `joint_1` to `joint_8`; an arm uses as many as it has.
template <Described T>
struct EachJoint {
  T joint_1 = {}, joint_2 = {}, joint_3 = {}, joint_4 = {}, joint_5 = {}, joint_6 = {}, joint_7 = {}, joint_8 = {};
  static constexpr auto fields() {
    using E = EachJoint;
    return List{
        field("joint_1", &E::joint_1, "The joint at the base."), field("joint_2", &E::joint_2, "The second joint."),
        field("joint_3", &E::joint_3, "The third joint."),       field("joint_4", &E::joint_4, "The fourth joint."),
        field("joint_5", &E::joint_5, "The fifth joint."),       field("joint_6", &E::joint_6, "The sixth joint."),
        field("joint_7", &E::joint_7, "The seventh joint."),     field("joint_8", &E::joint_8, "The eighth joint.")};
  }
  /// Of the first `joints`, 1 to 8. Not real-time safe.
  [[nodiscard]] Joints<T> of(std::size_t joints) const {
    Joints<T> found(joints);
    std::size_t at = 0;
    for_each_field<EachJoint>([&](const auto& each) {
      if (at < joints) found[at++] = this->*each.member;
    });
    return found;
  }
  /// One of their numbers, of the first `joints`.
  [[nodiscard]] arm::JointVector of(int joints, double T::*number) const {
    const Joints<T> each = of(static_cast<std::size_t>(joints));
    arm::JointVector found(joints);
    for (int i = 0; i < joints; ++i) found[i] = each[static_cast<std::size_t>(i)].*number;
    return found;
  }
};

/// A corner that a joint has for itself.
struct JointCutoff {
  double cutoff_Hz = 0.0;
  static constexpr auto fields() {
    return List{field("cutoff_Hz", &JointCutoff::cutoff_Hz, units::hertz, between(0.0, 1000.0),
                      "Corner frequency for this joint; 0: the frequency that is set for all joints.")};
  }
};

/// The corner of each joint: its own, or that of all.
inline arm::JointVector cutoffs(double of_all_Hz, const EachJoint<JointCutoff>& each, int joints) {
  const arm::JointVector own_Hz = each.of(joints, &JointCutoff::cutoff_Hz);
  return (own_Hz.array() > 0.0).select(own_Hz, of_all_Hz);
}

}  // namespace tactus::arm_control
