// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/ros_bag.hpp>
#include <tactus/identification/arm/bag_recording.hpp>

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

namespace tactus::arm_identification {
namespace {

using telemetry::BagSignal;
using SignalsByJoint = std::map<std::string, const BagSignal*>;

/// Of one topic, by quantity and joint.
using Topic = std::map<std::string, SignalsByJoint>;

bool has_all(const Topic& topic, const std::string& quantity, const std::vector<std::string>& joints) {
  const auto found = topic.find(quantity);
  return found != topic.end() && std::all_of(joints.begin(), joints.end(),
                                             [&](const std::string& joint) { return found->second.count(joint) != 0; });
}

}  // namespace

Result<ArmRecording> read_bag_arm(const std::string& file, const std::vector<std::string>& joints) {
  const auto bag = telemetry::read_bag(file);
  if (!bag) return bag.error();
  std::map<std::string, Topic> topics;
  for (const BagSignal& signal : bag->signals) topics[signal.topic][signal.quantity][signal.joint] = &signal;
  std::vector<std::string> fitting, followers;
  std::string listed;
  for (const auto& [name, topic] : topics) {
    const auto positions = topic.find("position");
    if (positions == topic.end()) continue;
    listed += (listed.empty() ? "" : "; ") + name + ":";
    for (const auto& [joint, signal] : positions->second) listed += " " + joint;
    if (!has_all(topic, "effort", joints)) {
      if (has_all(topic, "position", joints)) listed += " (without their efforts)";
      continue;
    }
    fitting.push_back(name);
    if (name.find("follower") != std::string::npos || name.find("slave") != std::string::npos)
      followers.push_back(name);
  }
  const std::vector<std::string>& chosen = followers.size() == 1 ? followers : fitting;
  if (chosen.size() != 1) {
    std::string wanted;
    for (const std::string& joint : joints) wanted += (wanted.empty() ? "" : ", ") + joint;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = (chosen.empty() ? "no topic of the bag has" : "more than one topic of the bag has") +
                            std::string(" position and effort of the arm's joints ") + wanted + "; it has " + listed +
                            ": record " + (chosen.empty() ? "them by these names" : "one arm alone"),
                 .place = file};
  }
  const Topic& topic = topics[chosen.front()];
  const bool has_velocity = has_all(topic, "velocity", joints);
  std::vector<ToldJoint> told;
  double longest_s = 0.0;
  for (const std::string& joint : joints) {
    const BagSignal& position = *topic.at("position").at(joint);
    const BagSignal& effort = *topic.at("effort").at(joint);
    ToldJoint one{.time_s = position.time_s, .position = position.values, .effort = effort.values};
    one.velocity = has_velocity ? topic.at("velocity").at(joint)->values : std::vector<double>(one.time_s.size(), 0.0);
    if (one.effort.size() != one.time_s.size() || one.velocity.size() != one.time_s.size()) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = {},
                   .message = "joint '" + joint + "' of " + chosen.front() +
                              " has not a position and an effort in every message: record it again",
                   .place = file};
    }
    const double steps = std::max(1.0, static_cast<double>(one.time_s.size()) - 1.0);
    longest_s = std::max(longest_s, (one.time_s.back() - one.time_s.front()) / steps);
    told.push_back(std::move(one));
  }
  auto recording = recording_of(file, told, joints, Seconds{longest_s > 0.0 ? longest_s : 1.0});
  if (recording && !has_velocity) recording->velocity.clear();
  return recording;
}

}  // namespace tactus::arm_identification
