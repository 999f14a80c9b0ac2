// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/arm_plants/internal/mujoco_text.hpp>

#include <sstream>

#include <Eigen/Geometry>

namespace tactus::arm_plants {
namespace {

/// Of MuJoCo's soft constraint for Coulomb friction: with its defaults, a joint that is pushed just below Coulomb's
/// torque creeps at more than 10 mrad/s; so at less than 1.
constexpr const char* sticks = "solreffriction='0.002 1' solimpfriction='0.99 0.99 0.001'";

/// Room for eight elastic joints with friction, which use 1000 numbers of this stack. MuJoCo's own choice is 13 MB an
/// arm, cleared at each load and copied with the arm.
constexpr const char* fits = "<size njmax='16' nconmax='0' nstack='20000'/>";

void write_joint(std::ostream& xml, const arm::JointParams& joint, const MotorParams& motor) {
  const auto begin = [&] {
    xml << "<joint type='" << (joint.kind == arm::JointKind::prismatic ? "slide" : "hinge") << "' axis='"
        << joint.axis.x << " " << joint.axis.y << " " << joint.axis.z << "' ";
  };
  begin();
  xml << "armature='" << joint.drive.reflected_kg_m2() << "' damping='" << joint.friction.viscous_N_m_s_per_rad
      << "' frictionloss='" << joint.friction.coulomb_N_m << "' " << sticks << "/>";
  if (motor.joint_stiffness_N_m_per_rad == 0.0) return;
  begin();
  if (motor.play_rad > 0.0) {  // its flanks are forces of ours
    xml << "/>";
    return;
  }
  xml << "stiffness='" << motor.joint_stiffness_N_m_per_rad << "' damping='" << motor.joint_damping_N_m_s_per_rad
      << "'/>";
}

}  // namespace

std::string mujoco_text(const ArmPlant::Params& params) {
  std::ostringstream xml;
  xml.precision(17);
  const arm::Gravity& g = params.chain.gravity;
  // Contacts and limits are not MuJoCo's: what touches the tool is located by who steps the arm, and end stops are
  // forces of the plant's own.
  xml << "<mujoco>" << fits
      << "<compiler angle='radian' inertiafromgeom='false' boundmass='0' boundinertia='0'/><option timestep='"
      << params.step_s << "' gravity='" << g.x_m_per_s2 << " " << g.y_m_per_s2 << " " << g.z_m_per_s2
      << "'><flag contact='disable' limit='disable'/></option><worldbody>";
  for (std::size_t i = 0; i < params.chain.joints.size(); ++i) {
    const arm::JointParams& joint = params.chain.joints[i];
    const Eigen::Quaterniond turn(arm::rotation_of(joint.origin));
    const arm::Body& body = joint.body;
    xml << "<body pos='" << joint.origin.x_m << " " << joint.origin.y_m << " " << joint.origin.z_m << "' quat='"
        << turn.w() << " " << turn.x() << " " << turn.y() << " " << turn.z() << "'><inertial mass='" << body.mass_kg
        << "' pos='" << body.centre_x_m << " " << body.centre_y_m << " " << body.centre_z_m << "' fullinertia='"
        << body.xx_kg_m2 << " " << body.yy_kg_m2 << " " << body.zz_kg_m2 << " " << body.xy_kg_m2 << " " << body.xz_kg_m2
        << " " << body.yz_kg_m2 << "'/>";
    write_joint(xml, joint, params.motors[i]);
  }
  if (params.carried_kg > 0.0) {
    constexpr double of_a_point_kg_m2 = 1e-9;
    xml << "<body pos='" << params.tool_m.x() << " " << params.tool_m.y() << " " << params.tool_m.z()
        << "'><inertial mass='" << params.carried_kg << "' pos='0 0 0' diaginertia='" << of_a_point_kg_m2 << " "
        << of_a_point_kg_m2 << " " << of_a_point_kg_m2 << "'/></body>";
  }
  for (std::size_t i = 0; i < params.chain.joints.size(); ++i) xml << "</body>";
  xml << "</worldbody></mujoco>";
  return xml.str();
}

}  // namespace tactus::arm_plants
