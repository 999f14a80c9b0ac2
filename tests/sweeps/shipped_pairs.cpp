// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/devices/rig/rig_arms.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

// Below what it uses.
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>

#include <filesystem>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

#include <tests/sweeps/arming_bench.hpp>

namespace tactus::sweeps {

namespace {

using configuration::Document;

const std::filesystem::path root = TACTUS_SOURCE_FOLDER;

experiments::ArmTappingParams read(const std::filesystem::path& file, std::initializer_list<const char*> with,
                                   std::initializer_list<std::pair<const char*, const char*>> set, std::int64_t pose) {
  auto document = Document::load(root / file).value();
  for (const char* other : with) {
    if (auto error = document.merge(Document::load(root / other).value())) throw std::runtime_error(describe(*error));
  }
  for (const auto& [key, value] : set) {
    if (auto error = document.set(std::string(key) + "=" + value)) throw std::runtime_error(describe(*error));
  }
  auto params = document.read<experiments::ArmTappingParams>().value();
  params.task.pose = pose;
  params.servo.plant_step_s = 2e-4;
  return params;
}

Joints<station::DeviceLimits> limits_of(const devices::RigSide& side, std::size_t joints) {
  Joints<station::DeviceLimits> limits(joints);
  for (std::size_t i = 0; i < joints; ++i) limits[i] = side.joints[i].joint.limits();
  return limits;
}

ShippedPair with_hanging(ShippedPair pair) {
  pair.leader_hangs = arming::hangs_at(pair.setup.leader.arm);
  pair.follower_hangs = arming::hangs_at(pair.setup.follower.arm);
  return pair;
}

/// The rig file of two arms with the experiment that drives it.
ShippedPair of_rig_file(std::int64_t pose) {
  const auto params = read("examples/rigs/arms.toml", {}, {}, pose);
  const auto setup = experiments::set_up_arm_pair(params, root / "examples/rigs").value();
  const auto rig = devices::Rig::load(root / "examples/rigs/openarm-arms.toml").value();
  const auto arms = devices::as_arms(rig.pairs().front(), params, setup).value();
  const std::size_t joints = setup.leader.joints.size();
  return with_hanging({.name = "openarm-arms.toml with arms.toml",
                       .setup = setup,
                       .leader_limits = limits_of(*arms.leader, joints),
                       .follower_limits = limits_of(*arms.follower, joints),
                       .leader_hangs = {},
                       .follower_hangs = {}});
}

/// An experiment with its gates, and devices that allow what the URDFs do, as in `tactus faults`.
ShippedPair of_experiment(std::string name, std::initializer_list<const char*> with,
                          std::initializer_list<std::pair<const char*, const char*>> set, std::int64_t pose) {
  const auto bench =
      experiments::make_arm_fault_bench(read("experiments/arm-tapping.toml", with, set, pose), root / "experiments");
  if (!bench) throw std::runtime_error(name + ": " + describe(bench.error()));
  return with_hanging({.name = std::move(name),
                       .setup = bench->setup,
                       .leader_limits = bench->leader_limits,
                       .follower_limits = bench->follower_limits,
                       .leader_hangs = {},
                       .follower_hangs = {}});
}

}  // namespace

std::vector<ShippedPair> shipped_pairs(std::int64_t pose) {
  std::vector<ShippedPair> pairs;
  pairs.push_back(of_rig_file(pose));
  pairs.push_back(of_experiment("arm-tapping.toml with limits.toml", {"experiments/arms/limits.toml"}, {}, pose));
  pairs.push_back(of_experiment("the same with yam-pair.toml",
                                {"experiments/arms/limits.toml", "experiments/arms/yam-pair.toml"},
                                {{"rig.probe_torque.joint_5.torque_N_m", "0.4"}}, pose));
  pairs.push_back(of_experiment("the same with geared-pair.toml",
                                {"experiments/arms/limits.toml", "experiments/arms/geared-pair.toml"},
                                {{"rig.follower_gate.force_limit_N", "87.0"},
                                 {"rig.probe_torque.joint_1.torque_N_m", "8.0"},
                                 {"rig.probe_torque.joint_2.torque_N_m", "8.0"},
                                 {"rig.probe_torque.joint_3.torque_N_m", "8.0"},
                                 {"rig.probe_torque.joint_4.torque_N_m", "8.0"},
                                 {"rig.probe_torque.joint_5.torque_N_m", "3.0"},
                                 {"rig.probe_torque.joint_6.torque_N_m", "3.0"},
                                 {"rig.probe_torque.joint_7.torque_N_m", "1.5"}},
                                pose));
  return pairs;
}

}  // namespace tactus::sweeps
