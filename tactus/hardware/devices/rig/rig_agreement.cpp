// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/rig_agreement.hpp>
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/station/agreed_arms.hpp>

#include <utility>
#include <variant>
#include <vector>

namespace tactus::devices {

namespace {

constexpr const char* remedy = "start both with the same experiment, the same --set and the same joints";

}  // namespace

/// The bindings point into the rest.
struct RigAgreement::Values {
  std::string kind;
  std::vector<std::string> joints;
  std::variant<control::AgreedParams, station::AgreedArms> params;
  std::vector<Binding> all;

  Values(std::string kind_, const RigSide& side, std::variant<control::AgreedParams, station::AgreedArms> params_)
      : kind(std::move(kind_)), params(std::move(params_)) {
    for (const RigJoint& joint : side.joints) {
      joints.push_back(std::string(joint.name()) + " in " + joint.words().position_unit);
    }
    const auto add = [this](std::string path, std::string& text) {
      all.push_back({.path = std::move(path), .unit = {}, .bounds = {}, .doc = {}, .target = &text});
    };
    add("task.kind", kind);
    for (std::size_t i = 0; i < joints.size(); ++i) add("joint " + std::to_string(i + 1) + " of the rig", joints[i]);
    std::visit([this](auto& agreed) { append_bindings(agreed, {}, all); }, params);
  }
  Values(const Values&) = delete;
  Values& operator=(const Values&) = delete;
  ~Values() = default;
};

RigAgreement RigAgreement::of(const RigSide& side, const control::ControlParams& control, Seconds tick) {
  return RigAgreement(std::make_shared<const Values>("tapping", side, control::agreed_params(control, tick)));
}

RigAgreement RigAgreement::of(const RigSide& side, const station::ArmTeleoperatorParams& params,
                              const station::DescribedArms& arms) {
  return RigAgreement(std::make_shared<const Values>("arm-tapping", side, station::agreed_arms(params, arms)));
}

control::Agreement RigAgreement::agreement() const { return control::agreement_of(values_->all); }

std::string RigAgreement::describe(const runtime::SiteMismatch& mismatch, control::SiteRole role) const {
  const auto found = control::first_disagreement(mismatch.agreement, values_->all);
  return runtime::describe(mismatch, role, found ? &*found : nullptr, remedy);
}

}  // namespace tactus::devices
