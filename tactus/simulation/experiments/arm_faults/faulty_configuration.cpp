// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_faults/faulty_configuration.hpp>

namespace tactus::experiments {

namespace {

void scale_masses(arm::Chain::Params& chain, double by) {
  for (auto& joint : chain.joints) {
    arm::Body& body = joint.body;
    for (double* of : {&body.mass_kg, &body.xx_kg_m2, &body.yy_kg_m2, &body.zz_kg_m2, &body.xy_kg_m2, &body.xz_kg_m2,
                       &body.yz_kg_m2}) {
      *of *= by;
    }
  }
}
/// As in a URDF in other units, whose inertias are mostly not converted.
void scale_lengths(arm::Chain::Params& chain, double by) {
  for (auto& joint : chain.joints) {
    for (double* of : {&joint.origin.x_m, &joint.origin.y_m, &joint.origin.z_m, &joint.body.centre_x_m,
                       &joint.body.centre_y_m, &joint.body.centre_z_m}) {
      *of *= by;
    }
  }
}

}  // namespace

FaultyArmConfiguration::FaultyArmConfiguration(const ArmPairSetup& setup, const FaultPlan& plan, FaultSite site)
    : params(setup.params), arms(setup) {
  if (plan.kind == FaultKind::model_wrong) overstate(plan);
  if (plan.kind == FaultKind::configurations_differ && plan.site == site) differ(key_of(plan));
}

void FaultyArmConfiguration::differ(std::size_t key) {
  constexpr double moved_m = 0.05;
  switch (key) {
    case 0:
      params.arm.tool.z_m += moved_m;
      arms.leader.arm.tool_m.z() += moved_m;
      break;
    case 1:
      params.rig.leader_gate.force_limit_N *= 0.8;
      break;
    case 2:
      params.rig.follower_gate.velocity_limit_m_per_s *= 0.8;
      break;
    case 3:
      params.rig.supervision.watchdog.timeout_s *= 3.0;
      break;
    case 4:
      params.control.force_gain *= 0.5;
      break;
    case 5:
      params.rig.gripper.stiffness_N_m_per_rad = 2.0 * params.rig.gripper.stiffness_N_m_per_rad + 0.1;
      break;
    default:
      scale_masses(arms.leader.arm.chain, 1.1);
  }
}

void FaultyArmConfiguration::overstate(const FaultPlan& plan) {
  const bool one_urdf = !station::differs(params.arm);
  const auto change = [&](arm::Chain::Params& chain) {
    is_of_lengths(plan) ? scale_lengths(chain, plan.size) : scale_masses(chain, plan.size);
  };
  if (one_urdf || plan.site == FaultSite::master) change(arms.leader.arm.chain);
  if (one_urdf || plan.site == FaultSite::slave) change(arms.follower.arm.chain);
  arms.exact.induced.chain = arms.leader.arm.chain;
}

}  // namespace tactus::experiments
