// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <utility>

namespace tactus::experiments {

namespace {

void scale_torque(arm::PhysicalArm& arm, const arm::JointVector& scale) {
  for (Eigen::Index i = 0; i < scale.size(); ++i) arm.motors[static_cast<std::size_t>(i)].torque_scale = scale[i];
}

/// What `model` lacks of an arm's gravity, by a tare in the pose in which it begins.
Result<arm::JointVector> tared(const ArmTappingParams& params, const arm::PhysicalArm& arm,
                               const arm::JointVector& start, const arm::Chain::Params& model) {
  const Seconds tick{1.0 / params.servo.rate_Hz};
  const auto chain = arm::Chain::make(model);
  if (!chain) return under("arm", chain.error());
  const auto& gains = params.control.follower.gains;
  auto tare = arm_control::Tare::make(
      params.control.tare, *chain,
      {.stiffness_N_m_per_rad = gains.of(chain->joints(), &arm_control::DriveGains::stiffness_N_m_per_rad),
       .damping_N_m_s_per_rad = gains.of(chain->joints(), &arm_control::DriveGains::damping_N_m_s_per_rad)},
      tick);
  if (!tare) return under("control.tare", tare.error());
  auto plant = arm_plants::ArmPlant::make(arm, start);
  if (!plant) return under("arm", plant.error());
  const auto steps = static_cast<int>(tick.value / arm.step_s + 0.5);
  arm::ArmCommand on_its_way = arm::ArmCommand::of_torque(chain->gravity_torque(start));
  while (!tare->done()) {
    const arm::ArmCommand command = tare->step(plant->read());
    plant->write(on_its_way);
    on_its_way = command;
    for (int i = 0; i < steps; ++i) plant->step({});
  }
  return tare->lacking_N_m();
}

}  // namespace

arm::Chain::Params with_payload(arm::Chain::Params chain, double payload_kg, const arm::Vector3& tool_m) {
  if (payload_kg == 0.0) return chain;
  const arm::Body point{
      .mass_kg = payload_kg, .centre_x_m = tool_m.x(), .centre_y_m = tool_m.y(), .centre_z_m = tool_m.z()};
  arm::Body& last = chain.joints[chain.joints.size() - 1].body;
  last = arm::body_of(arm::linear_parameters(last) + arm::linear_parameters(point));
  return chain;
}

ArmPlants plants_of(const ArmPairSetup& setup, const ArmPlantErrors& errors) {
  ArmPlants plants{.leader = setup.leader.arm, .follower = setup.follower.arm};
  scale_torque(plants.leader, errors.leader_torque_scale);
  scale_torque(plants.follower, errors.follower_torque_scale);
  plants.leader.chain = with_payload(plants.leader.chain, errors.leader_payload_kg, plants.leader.tool_m);
  plants.follower.chain = with_payload(plants.follower.chain, errors.follower_payload_kg, plants.follower.tool_m);
  return plants;
}

Check tare_arms(const ArmPairSetup& setup, const ArmPlantErrors& errors, ArmModelParams& model_params) {
  if (setup.params.control.tare.cycles == 0) return std::nullopt;
  const ArmPlants plants = plants_of(setup, errors);
  auto leader = tared(setup.params, plants.leader, setup.leader.start, model_params.leader);
  if (!leader) return leader.error();
  auto follower = tared(setup.params, plants.follower, setup.follower.start, model_params.follower);
  if (!follower) return follower.error();
  model_params.leader_lacking_N_m = *leader;
  model_params.follower_lacking_N_m = *follower;
  return std::nullopt;
}

}  // namespace tactus::experiments
