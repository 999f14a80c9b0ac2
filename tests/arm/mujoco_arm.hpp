// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/scratch_path.hpp"
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <mujoco/mujoco.h>

namespace tactus::arm {

/// The same arm in MuJoCo, written in its own format. Friction is left out.
class MuJoCoArm {
 public:
  explicit MuJoCoArm(const Chain::Params& params) {
    const std::string file = scratch_path().string() + ".xml";
    std::ofstream(file) << xml_of(params);
    load(file);
  }
  /// A file that MuJoCo reads by itself, such as a URDF.
  explicit MuJoCoArm(const std::string& file) { load(file); }
  MuJoCoArm(const MuJoCoArm&) = delete;
  MuJoCoArm& operator=(const MuJoCoArm&) = delete;
  ~MuJoCoArm() {
    if (data_ != nullptr) mj_deleteData(data_);
    if (model_ != nullptr) mj_deleteModel(model_);
  }

  explicit operator bool() const { return model_ != nullptr; }
  [[nodiscard]] std::string complaint() const { return complaint_.data(); }
  [[nodiscard]] int joints() const { return model_->nv; }
  [[nodiscard]] const mjModel& model() const { return *model_; }
  void set_gravity(const Vector3& g) {
    for (int i = 0; i < 3; ++i) model_->opt.gravity[i] = g[i];
  }

  Eigen::MatrixXd mass_matrix(const JointVector& q) {
    place(q, JointVector::Zero(q.size()));
    mj_forward(model_, data_);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> full(model_->nv, model_->nv);
    mj_fullM(model_, full.data(), data_->qM);
    return full;
  }
  Eigen::VectorXd inverse_dynamics(const JointVector& q, const JointVector& v, const JointVector& a) {
    place(q, v);
    for (int i = 0; i < model_->nv; ++i) data_->qacc[i] = a[i];
    mj_inverse(model_, data_);
    return Eigen::Map<const Eigen::VectorXd>(data_->qfrc_inverse, model_->nv);
  }
  /// Accelerations under torques at the joints.
  Eigen::VectorXd forward_dynamics(const JointVector& q, const JointVector& v, const Eigen::VectorXd& torque) {
    place(q, v);
    for (int i = 0; i < model_->nv; ++i) data_->qfrc_applied[i] = torque[i];
    mj_forward(model_, data_);
    return Eigen::Map<const Eigen::VectorXd>(data_->qacc, model_->nv);
  }

 private:
  void load(const std::string& file) {
    model_ = mj_loadXML(file.c_str(), nullptr, complaint_.data(), static_cast<int>(complaint_.size()));
    if (model_ == nullptr) return;
    model_->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_FRICTIONLOSS;
    data_ = mj_makeData(model_);
  }
  void place(const JointVector& q, const JointVector& v) {
    for (int i = 0; i < model_->nv; ++i) {
      data_->qpos[i] = q[i];
      data_->qvel[i] = v[i];
    }
  }

  static std::string xml_of(const Chain::Params& params) {
    std::ostringstream xml;
    xml.precision(17);
    const Gravity& g = params.gravity;
    xml << "<mujoco><compiler angle='radian' inertiafromgeom='false' boundmass='0' boundinertia='0'/><option gravity='"
        << g.x_m_per_s2 << " " << g.y_m_per_s2 << " " << g.z_m_per_s2 << "'/><worldbody>";
    for (const JointParams& joint : params.joints) {
      const Eigen::Quaterniond turn(rotation_of(joint.origin));
      const Body& body = joint.body;
      xml << "<body pos='" << joint.origin.x_m << " " << joint.origin.y_m << " " << joint.origin.z_m << "' quat='"
          << turn.w() << " " << turn.x() << " " << turn.y() << " " << turn.z() << "'><inertial mass='" << body.mass_kg
          << "' pos='" << body.centre_x_m << " " << body.centre_y_m << " " << body.centre_z_m << "' fullinertia='"
          << body.xx_kg_m2 << " " << body.yy_kg_m2 << " " << body.zz_kg_m2 << " " << body.xy_kg_m2 << " "
          << body.xz_kg_m2 << " " << body.yz_kg_m2 << "'/><joint type='"
          << (joint.kind == JointKind::prismatic ? "slide" : "hinge") << "' axis='" << joint.axis.x << " "
          << joint.axis.y << " " << joint.axis.z << "' armature='" << joint.drive.reflected_kg_m2() << "'/>";
    }
    for (std::size_t i = 0; i < params.joints.size(); ++i) xml << "</body>";
    xml << "</worldbody></mujoco>";
    return xml.str();
  }

  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::array<char, 1000> complaint_{};
};

}  // namespace tactus::arm
