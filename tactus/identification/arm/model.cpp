// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/identification/arm/model.hpp>

#include <algorithm>
#include <vector>

namespace tactus::arm_identification {
namespace {

std::vector<Binding> bindings_of(ArmModel& model) {
  std::vector<Binding> bindings = tactus::bind(model.head, "arm", "The arm.");
  for (std::size_t joint = 0; joint < model.joints.size(); ++joint) {
    std::vector<Binding> own =
        tactus::bind(model.joints[joint], "joint_" + std::to_string(joint + 1), "A joint and its link.");
    std::move(own.begin(), own.end(), std::back_inserter(bindings));
  }
  return bindings;
}

}  // namespace

arm::Chain::Params ArmModel::chain() const {
  arm::Chain::Params params{.joints = Joints<arm::JointParams>(joints.size()), .gravity = head.gravity};
  for (std::size_t joint = 0; joint < joints.size(); ++joint) params.joints[joint] = joints[joint].arm;
  return params;
}

std::string to_toml(const ArmModel& model, std::string_view comment) {
  ArmModel copy = model;
  return "# " + std::string(comment) + "\n" + configuration::to_toml(bindings_of(copy));
}

Result<ArmModel> load_arm_model(const std::filesystem::path& file) {
  const auto document = configuration::Document::load(file);
  if (!document) return document.error();
  const std::vector<std::string> keys = document->keys();
  std::size_t joints = 0;
  while (joints < most_joints && std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
           return key.starts_with("joint_" + std::to_string(joints + 1) + ".");
         })) {
    ++joints;
  }
  if (joints == 0) {
    return Error{.code = ErrorCode::missing,
                 .parameter = "joint_1",
                 .message = "is no model of an arm; name the model.toml that `identify arm --out` leaves",
                 .place = file.string()};
  }
  ArmModel model{.head = {}, .joints = Joints<ArmJointModel>(joints)};
  if (Check wrong = document->read(bindings_of(model))) return *std::move(wrong);
  if (static_cast<std::size_t>(model.head.joints) != joints) {
    return document->locate({.code = ErrorCode::inconsistent,
                             .parameter = "arm.joints",
                             .message = std::to_string(model.head.joints) + " joints are stated, but " +
                                        std::to_string(joints) + " described; is the file whole?",
                             .place = {}});
  }
  const auto chain = arm::Chain::make(model.chain());
  if (!chain) return document->locate(chain.error());
  return model;
}

}  // namespace tactus::arm_identification
