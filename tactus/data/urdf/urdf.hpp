// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <string>
#include <vector>

/// Arms from URDF files, the format in which makers of robots and ROS describe them.
namespace tactus::urdf {

/// A link of a body.
struct LinkFrame {
  std::string name;
  arm::Vector3 origin_m;  ///< in the frame of the body's first link
};

/// A serial arm as a file describes it.
struct Arm {
  std::string name = {};
  std::string base = {};  ///< the link that does not move
  /// Joints that move, from the base on, and the links right behind them.
  std::vector<std::string> joints = {};
  std::vector<std::string> links = {};
  /// For each of those joints: the link behind it first, then all that are fixed to it. The tool is among the last.
  std::vector<std::vector<LinkFrame>> frames = {};
  /// Gravity is 9.81 m/s² along −z of the base. Limits and `dynamics` are taken over; `friction` is Coulomb's,
  /// `damping` viscous.
  arm::Chain::Params params = {};
  /// What the file states that cannot be and does not count, each with `file:line`: an impossible body that moves no
  /// joint.
  std::vector<std::string> warnings = {};
  /// Limits that are 0 and so count as not stated, and ranges that are absent, each with `file:line`, joint and limit:
  /// what drives or simulates the arm needs them.
  std::vector<std::string> doubtful_limits = {};
};

/// Reads the chain of moving joints from the root of the file to its end.
///
/// What is joined by fixed joints counts as one body, with masses and inertia added. Meshes, collisions, materials and
/// transmissions are not looked at. With `tip`, the name of a link, the chain is the one that leads there, and every
/// joint off it, such as the fingers of a gripper, counts as fixed at 0.
///
/// Errors, each with `file:line`, the joint or link, the value and the remedy: `missing` for the file, a link, a
/// joint's parent or child, an `inertial` of a body that moves; `syntax` for text that is not XML or no robot, and for
/// what is not a number; `inconsistent` for a chain that branches, has no single root or goes in a circle, for more
/// than eight moving joints, for a joint of the chain that is floating, planar or mimics another or whose lower limit
/// is above its upper one, and for an inertia that no body can have, unless that body moves no joint; `out_of_bounds`
/// for a number that is not finite, a negative mass, and a file beyond 4 MiB, 1,000 links or 1,000 joints. Not
/// real-time safe. Source: the URDF specification, http://wiki.ros.org/urdf/XML.
Result<Arm> read(const std::filesystem::path& file, const std::string& tip = {});

/// The same in two parts: the text of the file, and the chain of the text, where errors name `file`.
Result<std::string> text_of(const std::filesystem::path& file);
Result<Arm> parse(const std::string& text, const std::filesystem::path& file, const std::string& tip = {});

/// The text of the file with other bodies, damping and Coulomb friction, and all else as it is: names, limits, meshes,
/// what is off the chain. A joint whose axis in `arm` points against that of the file is written with that axis, and
/// its range is turned round. `arm`: as `read` made it of this file, its `params` with the new numbers. A body is
/// written to the link behind its joint; links that are fixed to that lose theirs, since it is in there. `comment` is
/// put at the top of the robot, without "--", which XML forbids there. Read back with the same `tip`, it has these
/// bodies to rounding. Relative paths of meshes stay as they are, so they count from another folder where the text is
/// written to one. Errors: those of `read` that concern the file and its XML. Not real-time safe.
Result<std::string> with_dynamics(const std::filesystem::path& file, const Arm& arm, const std::string& comment);

}  // namespace tactus::urdf
