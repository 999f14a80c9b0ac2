// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tactus::devices::rig_test {

/// A joint's section with the keys that all need.
inline std::string joint(const std::string& path, int motor, const std::string& model, const std::string& more = {}) {
  return "[" + path + "]\nmotor = " + std::to_string(motor) + "\nmodel = \"" + model +
         "\"\nlower_rad = -1.5\nupper_rad = 1.5\nvelocity_limit_rad_per_s = 3.0\ntorque_limit_Nm = 2.0\n"
         "torque_rate_limit_Nm_per_s = 50.0\n" +
         more;
}

inline std::string damiao_side(const std::string& path, const std::string& port) {
  return "[" + path + "]\nbus = \"damiao\"\nport = \"" + port + "\"\n";
}

}  // namespace tactus::devices::rig_test
