// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/kernel/control/agreement.hpp>
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/kernel/station/arm_teleoperator_params.hpp>
#include <tactus/kernel/station/described_arms.hpp>
#include <tactus/runtime/servo/site_mismatch.hpp>

#include <memory>
#include <string>

namespace tactus::devices {

/// What two programs that drive a side of a rig each must have in common before either arms: the kind of experiment;
/// the joints by name, unit and order; and what both sites compute with. Ports, motors, offsets, gears and the limits
/// of joints are each host's own affair. Not real-time safe.
class RigAgreement {
 public:
  /// Of joints that are driven each by itself: with them, all that sites of one axis must agree on (`AgreedParams`).
  static RigAgreement of(const RigSide& side, const control::ControlParams& control, Seconds tick);
  /// Of two arms: with them the rate, all of `[control]`, the gates, both arms' dynamics, and what the sites do in
  /// silence.
  static RigAgreement of(const RigSide& side, const station::ArmTeleoperatorParams& params,
                         const station::DescribedArms& arms);

  [[nodiscard]] control::Agreement agreement() const;
  /// What the operator at the site of this role must know about a mismatch, in one sentence with the remedy.
  [[nodiscard]] std::string describe(const runtime::SiteMismatch& mismatch, control::SiteRole role) const;

 private:
  struct Values;
  explicit RigAgreement(std::shared_ptr<const Values> values) : values_(std::move(values)) {}
  std::shared_ptr<const Values> values_;
};

}  // namespace tactus::devices
