// SPDX-License-Identifier: Apache-2.0
// simulated_arm FOLDER: writes the recordings of a simulated arm that docs/how-to/identify-an-arm.md works on, and its
// URDF: the first three joints of tests/arm_identification/kdl_arm.hpp, sampled at 100 Hz.

#include <cstdio>
#include <fstream>
#include <string>

#include "tests/arm_identification/kdl_arm.hpp"

namespace {

using namespace tactus;

arm::Chain::Params three_joints() {
  const arm::Chain::Params whole = arm_identification::open_arm();
  arm::Chain::Params params{.joints = Joints<arm::JointParams>(3), .gravity = whole.gravity};
  for (std::size_t j = 0; j < 3; ++j) params.joints[j] = whole.joints[j];
  return params;
}

bool write_recording(const std::string& file, const std::string& what, const arm_identification::Samples& samples) {
  std::ofstream text(file);
  text << "# Simulated, not measured: " << what << ".\n# Written by simulated_arm (tests/arm_identification).\n";
  text << "time_s,shoulder_1_rad,shoulder_2_rad,elbow_rad,shoulder_1_rad_per_s,shoulder_2_rad_per_s,elbow_rad_per_s,"
          "shoulder_1_N_m,shoulder_2_N_m,elbow_N_m\n";
  char number[32];
  for (std::size_t i = 0; i < samples.time_s.size(); ++i) {
    std::snprintf(number, sizeof number, "%.2f", samples.time_s[i]);
    text << number;
    for (const auto* columns : {&samples.position, &samples.velocity, &samples.torque}) {
      for (const auto& column : *columns) {
        std::snprintf(number, sizeof number, columns == &samples.position ? ",%.5f" : ",%.4f", column[i]);
        text << number;
      }
    }
    text << "\n";
  }
  return text.good();
}

/// As a drawing would have it: masses off by up to 20 %, no friction, no motors' inertia.
bool write_urdf(const std::string& file, const arm::Chain::Params& params) {
  std::ofstream text(file);
  const char* names[] = {"shoulder_1", "shoulder_2", "elbow"};
  text << "<?xml version=\"1.0\"?>\n<!-- The simulated arm of docs/how-to/identify-an-arm.md, as its drawings have it. "
          "-->\n"
       << "<robot name=\"three_joints\">\n  <link name=\"base\"/>\n";
  for (std::size_t j = 0; j < 3; ++j) {
    const arm::Body& b = params.joints[j].body;
    text << "  <link name=\"" << names[j] << "_link\">\n    <inertial>\n      <origin xyz=\"" << b.centre_x_m << " "
         << b.centre_y_m << " " << b.centre_z_m << "\"/>\n      <mass value=\"" << b.mass_kg
         << "\"/>\n      <inertia ixx=\"" << b.xx_kg_m2 << "\" iyy=\"" << b.yy_kg_m2 << "\" izz=\"" << b.zz_kg_m2
         << "\" ixy=\"" << b.xy_kg_m2 << "\" ixz=\"" << b.xz_kg_m2 << "\" iyz=\"" << b.yz_kg_m2
         << "\"/>\n    </inertial>\n  </link>\n";
  }
  for (std::size_t j = 0; j < 3; ++j) {
    const arm::JointParams& p = params.joints[j];
    const std::string before = j == 0 ? std::string("base") : std::string(names[j - 1]) + "_link";
    text << "  <joint name=\"" << names[j] << "\" type=\"revolute\">\n    <parent link=\"" << before
         << "\"/>\n    <child link=\"" << names[j] << "_link\"/>\n    <origin xyz=\"" << p.origin.x_m << " "
         << p.origin.y_m << " " << p.origin.z_m << "\"/>\n    <axis xyz=\"" << p.axis.x << " " << p.axis.y << " "
         << p.axis.z << "\"/>\n    <limit lower=\"-2.5\" upper=\"2.5\" velocity=\"5\" effort=\"15\"/>\n  </joint>\n";
  }
  text << "</robot>\n";
  return text.good();
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "use: simulated_arm FOLDER\n");
    return 2;
  }
  const std::string folder = std::string(words[1]) + "/";
  const arm::Chain::Params truth = three_joints();
  arm_identification::Session free{.duration_s = 12.0, .seed = 1, .steps_between = 40};
  arm_identification::Session pushed{.duration_s = 8.0, .seed = 2, .steps_between = 40, .pushes = {{3.0, 3.8, 20.0}}};
  const bool written =
      write_recording(folder + "arm-free-motion.csv", "an arm of three joints that nothing touches",
                      arm_identification::simulate(truth, free)) &&
      write_recording(folder + "arm-pushed.csv", "the same arm, pushed at its last joint with 20 N from 3.0 to 3.8 s",
                      arm_identification::simulate(truth, pushed)) &&
      write_urdf(folder + "three-joints.urdf", arm_identification::believed(truth, 1));
  return written ? 0 : 1;
}
