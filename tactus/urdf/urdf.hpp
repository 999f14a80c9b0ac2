#pragma once

#include <tactus/arm/chain.hpp>
#include <tactus/core/result.hpp>

#include <filesystem>
#include <string>
#include <vector>

/// Arms from URDF files, the format in which makers of robots and ROS describe them.
namespace tactus::urdf {

/// A serial arm as a file describes it.
struct Arm {
  std::string name = {};
  std::string base = {};  ///< the link that does not move
  /// Joints that move, from the base on, and the links right behind them.
  std::vector<std::string> joints = {};
  std::vector<std::string> links = {};
  /// Gravity is 9.81 m/s² along −z of the base. Limits and `dynamics` are taken over; `friction` is Coulomb's,
  /// `damping` viscous.
  arm::Chain::Params params = {};
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
/// than eight moving joints, for a joint of the chain that is floating, planar or mimics another, and for an inertia
/// that no body can have; `out_of_bounds` for a number that is not finite, a negative mass, and a file beyond 4 MiB,
/// 1,000 links or 1,000 joints. Not real-time safe. Source: the URDF specification, http://wiki.ros.org/urdf/XML.
Result<Arm> read(const std::filesystem::path& file, const std::string& tip = {});

}  // namespace tactus::urdf
