// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/urdf/urdf.hpp>
#include <tactus/identification/arm/model.hpp>
#include <tactus/interfaces/cli/command.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

TEST(IdentifiedUrdf, IsTheModelThatWasFound) {
  const std::filesystem::path folder = scratch_path();
  const std::string recordings = TACTUS_EXAMPLE_FOLDER "/recordings";
  std::vector<std::string> words{"tactus",     "identify",
                                 "arm",        recordings + "/arm-free-motion.csv",
                                 "--urdf",     recordings + "/three-joints.urdf",
                                 "--gravity",  "0,-9.81,0",
                                 "--time",     "1",
                                 "--position", "2:4",
                                 "--velocity", "5:7",
                                 "--effort",   "8:10",
                                 "--out",      folder.string()};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  ASSERT_EQ(run_command(static_cast<int>(arguments.size()), arguments.data()), 0);
  const auto read = urdf::read(folder / "arm.urdf");
  ASSERT_TRUE(read) << describe(read.error());
  const auto model = arm_identification::load_arm_model(folder / "model.toml");
  ASSERT_TRUE(model) << describe(model.error());
  std::ostringstream armatures;
  armatures << std::ifstream(folder / "armatures.toml").rdbuf();
  arm::Chain::Params as_read = read->params;
  as_read.gravity = model->head.gravity;
  for (std::size_t j = 0; j < 3; ++j) {
    const std::string key = "joint_" + std::to_string(j + 1) + " = { armature_kg_m2 = ";
    const std::size_t at = armatures.str().find(key);
    ASSERT_NE(at, std::string::npos) << armatures.str();
    as_read.joints[j].drive.armature_kg_m2 = std::stod(armatures.str().substr(at + key.size()));
    EXPECT_EQ(as_read.joints[j].friction.coulomb_N_m, model->joints[j].arm.friction.coulomb_N_m);
    EXPECT_EQ(as_read.joints[j].friction.viscous_N_m_s_per_rad, model->joints[j].arm.friction.viscous_N_m_s_per_rad);
  }
  const arm::Chain of_urdf = *arm::Chain::make(as_read);
  const arm::Chain of_model = *arm::Chain::make(model->chain());
  for (int i = 0; i < 20; ++i) {
    const arm::JointVector q{{0.3 * i, 1.0 - 0.2 * i, -0.1 * i}};
    const arm::JointVector v{{1.0, -0.1 * i, 0.5}};
    const arm::JointVector a{{-3.0, 2.0 + i, 5.0}};
    EXPECT_LT((of_urdf.inverse_dynamics(q, v, a) - of_model.inverse_dynamics(q, v, a)).cwiseAbs().maxCoeff(), 1e-9);
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace tactus::cli
