// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/hardware/devices/rig/pose_guide.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/interfaces/cli/device_guide.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <thread>
#include <vector>

namespace tactus::cli {

namespace {

using arm::JointVector;
using devices::GuideFault;
using devices::GuideFinding;
using devices::Rig;
using devices::RigJoint;
using devices::RigSide;

Error refused(ErrorCode code, const std::string& parameter, std::string message) {
  return {.code = code, .parameter = parameter, .message = std::move(message), .place = {}};
}

/// Where each of the arm's joints is among those of the side.
Result<std::vector<std::size_t>> places_of(const station::DescribedArm& arm, const RigSide& side) {
  std::vector<std::size_t> places;
  for (const std::string& name : arm.joints) {
    const auto found = std::ranges::find(side.joints, name, &RigJoint::name);
    if (found == side.joints.end()) {
      return refused(ErrorCode::missing, side.path,
                     "the arm of " + arm.urdf + " has a joint " + name + ", and the rig has no such joint");
    }
    places.push_back(static_cast<std::size_t>(found - side.joints.begin()));
  }
  return places;
}

std::string pose_text(const station::DescribedArm& arm, const arm::Chain& chain, const JointVector& pose) {
  report::Table table({{"joint", "", report::Column::Align::left},
                       {"position", "rad"},
                       {"position", "°"},
                       {"x", "m"},
                       {"y", "m"},
                       {"z", "m"}});
  const auto links = chain.poses(pose);
  const auto add = [&table](const std::string& name, const std::string& rad, const std::string& degrees,
                            const arm::Vector3& at_m) {
    table.add_row(
        {name, rad, degrees, report::fixed(at_m.x(), 2), report::fixed(at_m.y(), 2), report::fixed(at_m.z(), 2)});
  };
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const double at_rad = pose[static_cast<Eigen::Index>(i)];
    add(arm.joints[i], report::fixed(at_rad, 2), report::fixed(at_rad * 180.0 / std::numbers::pi, 0),
        links[i].position_m);
  }
  const arm::LinkPose& last = links[links.size() - 1];
  add("tool", "", "", last.position_m + last.rotation * arm.arm.tool_m);
  return table.to_text();
}

std::string words_of(const GuideFinding& finding, const RigJoint& joint, const RigSide& side,
                     const std::vector<std::size_t>& places) {
  const std::string read = report::fixed(finding.read_rad, 2), expected = report::fixed(finding.expected_rad, 2);
  const std::string turned = "it read " + read + " rad for " + expected + " rad";
  switch (finding.fault) {
    case GuideFault::none:
      return {};
    case GuideFault::unmoved:
      return turned + ": is it motor " + std::to_string(joint.motor.id) + ", and was it moved?";
    case GuideFault::swapped: {
      const RigJoint& other = side.joints[places[finding.other]];
      return "it read the motion of " + other.path + ": exchange their motors, " + std::to_string(joint.motor.id) +
             " and " + std::to_string(other.motor.id);
    }
    case GuideFault::direction:
      return turned + ", the other way: write sign = " + std::to_string(-joint.joint.sign);
    case GuideFault::gear:
      return turned +
             ": write gear = " + report::number(joint.joint.gear * finding.read_rad / finding.expected_rad, 2) +
             ", or the exact ratio near it";
    case GuideFault::zero:
      return "it read " + read + " rad in the first pose, not " + expected + " rad: write offset_rad = " +
             report::fixed(joint.joint.offset_rad - finding.read_rad + finding.expected_rad, 2);
  }
  return {};
}

/// What the motors of the arm read now, once all of them have responded.
Result<JointVector> reading_of(const RigSide& side, const devices::MotorLink& bus,
                               const std::vector<std::size_t>& places) {
  constexpr int most_looks = 100;
  constexpr std::chrono::milliseconds between_looks{20};
  const auto responds = [&places](const devices::BusReadings& now) {
    return std::ranges::all_of(places, [&now](std::size_t place) { return now.motors[place].answers > 0; });
  };
  auto now = bus.newest();
  for (int look = 0; look < most_looks && !(now && responds(*now)); ++look) {
    std::this_thread::sleep_for(between_looks);
    now = bus.newest();
  }
  JointVector read(static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const RigJoint& joint = side.joints[places[i]];
    if (!now || now->motors[places[i]].answers == 0) {
      return refused(ErrorCode::failed, joint.path, "its motor did not respond: run 'tactus device check'");
    }
    read[static_cast<Eigen::Index>(i)] = joint.joint.first_position_rad(now->motors[places[i]].position_rad);
  }
  return read;
}

}  // namespace

Result<bool> guide_arm(const std::string& rig_file, const std::string& name, const std::string& experiment) {
  const auto rig = Rig::load(rig_file);
  if (!rig) return rig.error();
  const auto sides = rig->sides(name);
  if (!sides) return rig->locate(sides.error());
  if (sides->size() != 1) {
    return refused(ErrorCode::inconsistent, "NAME", "one arm at a time: name a side of the rig, such as arm.leader");
  }
  const RigSide& side = *sides->front();
  const auto document = configuration::Document::load(experiment);
  if (!document) return document.error();
  const auto params = document->read<experiments::ArmTappingParams>();
  if (!params) return params.error();
  const auto setup = experiments::set_up_arm_pair(*params, std::filesystem::path(experiment).parent_path());
  if (!setup) return document->locate(setup.error());
  const station::DescribedArm& arm = side.path.ends_with(".follower") ? setup->follower : setup->leader;
  const auto places = places_of(arm, side);
  if (!places) return rig->locate(places.error());
  const auto chain = arm::Chain::make(arm.arm.chain);
  if (!chain) return chain.error();
  auto bus = devices::start(side.bus);
  if (!bus) return bus.error().place.empty() ? rig->locate(side, bus.error()) : bus.error();
  constexpr Seconds longest{10.0};
  if (Check wrong = (*bus)->wait_until_asked(longest)) return *std::move(wrong);

  const auto poses = devices::guide_poses(arm.arm.chain);
  std::vector<JointVector> read;
  for (const JointVector& pose : poses) {
    std::cout << "Pose " << read.size() + 1 << " of " << poses.size() << ": move " << side.path
              << " by hand to these positions, where each joint and the tool are at x, y, z in the base's frame. "
                 "Then press Enter.\n"
              << pose_text(arm, *chain, pose);
    if (Check error = flush_standard_output()) return *std::move(error);
    std::string line;
    if (!std::getline(std::cin, line)) {
      return refused(ErrorCode::failed, "", "standard input has ended before the last pose: start again");
    }
    auto now = reading_of(side, **bus, *places);
    if (!now) return rig->locate(now.error());
    read.push_back(*std::move(now));
  }
  const auto found = devices::judge_poses(poses, read);
  bool agrees = true;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].fault == GuideFault::none) continue;
    const RigJoint& joint = side.joints[(*places)[i]];
    std::cout << joint.path << ": " << name_of(found[i].fault) << ": " << words_of(found[i], joint, side, *places)
              << "\n";
    agrees = false;
  }
  if (agrees) std::cout << side.path << " agrees with " << arm.urdf << " in direction, zero and gear of each joint.\n";
  if (Check error = flush_standard_output()) return *std::move(error);
  return agrees;
}

}  // namespace tactus::cli
