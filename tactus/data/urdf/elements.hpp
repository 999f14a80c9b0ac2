// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/joint.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tinyxml2 {  // NOLINT: the name is not ours
class XMLDocument;
}

namespace tactus::urdf {

/// A body as `<inertial>` gives it: mass, its centre and inertia along axes that are turned against the link's.
struct Inertial {
  double mass_kg = 0.0;
  arm::JointOrigin origin = {};
  /// About the centre: only the moments are set.
  arm::Body moments = {};
  int line = 0;
  /// Why no body can be like this; of no concern for one that moves no joint.
  Check fault = {};
};

struct Link {
  std::string name;
  std::optional<Inertial> inertial;
  int line = 0;
};

struct Joint {
  std::string name;
  std::string type;
  std::string parent;
  std::string child;
  bool mimics = false;
  arm::JointOrigin origin = {};
  arm::JointAxis axis = {};
  arm::JointLimits limits = {};
  bool has_range = false;  ///< lower or upper is written
  double damping = 0.0;
  double friction = 0.0;
  int line = 0;
};

/// All that a file states of links and joints, in its order.
struct Robot {
  std::string name;
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::map<std::string, std::size_t> link_by_name;
};

/// Reads the elements of the text; `read` in urdf.hpp lists the errors, which name `file`. A joint's links are known to
/// be there.
Result<Robot> read_elements(const std::string& text, const std::filesystem::path& file);

/// Reads text whose outermost element is <robot>; the same.
Check load(const std::string& text, const std::filesystem::path& file, tinyxml2::XMLDocument& into);

/// `file:line`.
std::string place(const std::filesystem::path& file, int line);

}  // namespace tactus::urdf
