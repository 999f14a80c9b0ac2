#include <tactus/experiments/arm_tapping/described_arm.hpp>
#include <tactus/urdf/urdf.hpp>

#include <cstddef>

namespace tactus::experiments {

Result<DescribedArm> describe_arm(const ArmPairParams& params, const std::filesystem::path& folder) {
  if (params.urdf.empty()) {
    return Error{.code = ErrorCode::missing,
                 .parameter = "arm.urdf",
                 .message = "which arm? Name its URDF file, such as arms/openarm-class.urdf",
                 .place = {}};
  }
  const auto read = urdf::read(folder / params.urdf);
  if (!read) return Error{read.error().code, "arm.urdf", describe(read.error()), {}};
  const std::size_t joints = read->joints.size();
  const Joints<ArmJoint> described = params.joints.of(joints);
  DescribedArm found{.joints = read->joints,
                     .arm = {.chain = read->params, .motors = Joints<arm_plants::MotorParams>(joints)},
                     .start = arm::JointVector::Zero(static_cast<Eigen::Index>(joints))};
  for (std::size_t i = 0; i < joints; ++i) {
    const ArmJoint& from = described[i];
    arm::JointParams& joint = found.arm.chain.joints[i];
    joint.drive.armature_kg_m2 = from.armature_kg_m2;
    found.arm.motors[i] = {.torque_limit_N_m = joint.limits.effort_N_m,
                           .position_step_rad = from.position_step_rad,
                           .velocity_step_rad_per_s = from.velocity_step_rad_per_s,
                           .torque_step_N_m = from.torque_step_N_m,
                           .joint_stiffness_N_m_per_rad = from.stiffness_share * params.joint_stiffness_N_m_per_rad,
                           .joint_damping_N_m_s_per_rad = from.stiffness_share * params.joint_damping_N_m_s_per_rad};
    found.start[static_cast<Eigen::Index>(i)] = from.start_rad;
  }
  found.arm.tool_m = arm::Vector3(params.tool.x_m, params.tool.y_m, params.tool.z_m);
  return found;
}

}  // namespace tactus::experiments
