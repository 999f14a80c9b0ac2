// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tactus::ros2 {

/// `sensor_msgs/msg/JointState`. Each of the last three is empty or has one number for each joint.
struct JointState {
  static constexpr const char* type_name = "sensor_msgs/msg/JointState";
  static constexpr const char* type_hash =  //
      "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e";
  std::int64_t stamp_ns = 0;  ///< since 1970; from 0 to the end of 2037
  std::string frame_id = {};
  std::vector<std::string> name = {};
  std::vector<double> position = {};  ///< in m for a joint that slides
  std::vector<double> velocity = {};  ///< in m/s
  std::vector<double> effort = {};    ///< in N
  bool operator==(const JointState&) const = default;
};

/// `geometry_msgs/msg/WrenchStamped`.
struct WrenchStamped {
  static constexpr const char* type_name = "geometry_msgs/msg/WrenchStamped";
  static constexpr const char* type_hash = "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77";
  std::int64_t stamp_ns = 0;
  std::string frame_id = {};
  std::array<double, 3> force_N{};
  std::array<double, 3> torque_Nm{};
  bool operator==(const WrenchStamped&) const = default;
};

/// `std_msgs/msg/String`.
struct Text {
  static constexpr const char* type_name = "std_msgs/msg/String";
  static constexpr const char* type_hash = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18";
  std::string data = {};
  bool operator==(const Text&) const = default;
};

}  // namespace tactus::ros2
