// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <string>
#include <string_view>

/// ROS 2 without ROS: the same DDS topics, types, qualities of service and type hashes that a ROS 2 node uses.
namespace tactus::ros2 {

/// Which other programs are met.
struct Network {
  std::uint32_t domain = 0;    ///< programs of different domains do not see one another
  bool loopback_only = false;  ///< only programs on this machine
  /// Configuration of Cyclone DDS, as CYCLONEDDS_URI has it; not read with `loopback_only`: it could bring other
  /// interfaces back in.
  std::string configuration = {};
};

/// The variables that choose the network, as text; null where one is not set.
struct Environment {
  const char* domain_id = nullptr;        ///< ROS_DOMAIN_ID: 0 to 232, 0 where it is empty
  const char* localhost_only = nullptr;   ///< ROS_LOCALHOST_ONLY: 0 or 1 (to Humble)
  const char* discovery_range = nullptr;  ///< ROS_AUTOMATIC_DISCOVERY_RANGE: SUBNET or LOCALHOST (from Iron on)
  const char* configuration = nullptr;    ///< CYCLONEDDS_URI
};

/// Those of this process.
Environment environment();

/// Errors, the variable as their place: `syntax` for a domain that is no whole number and for an unknown word,
/// `out_of_bounds` for a domain beyond 232, whose ports would be beyond 65535.
Result<Network> network_of(const Environment& variables);

/// Whether topics can be put under it: words of letters, digits and single underscores that begin with a letter or an
/// underscore, `/` between them (`tactus`, `lab/left`), 128 characters at most. Errors: `syntax`.
Check check_namespace(std::string_view name_space);

/// What DDS calls the ROS 2 topic `/name_space/topic`: `rt/tactus/master/measured_js`.
std::string dds_topic(std::string_view name_space, std::string_view topic);

}  // namespace tactus::ros2
