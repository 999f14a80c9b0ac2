// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/site_pair.hpp>

#include <algorithm>
#include <utility>

#include <tests/sweeps/arming_bench.hpp>

namespace tactus::sweeps {

Beliefs truth_of(const ShippedPair& pair) {
  return {.leader = pair.setup.leader.arm.chain,
          .follower = pair.setup.follower.arm.chain,
          .leader_wiring = {},
          .follower_wiring = {}};
}

bool ShippedPair::hangs_freely() const {
  const auto is_free = [](const arm::Chain::Params& chain, const arm::JointVector& hangs) {
    constexpr double clear_rad = 0.1;
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      const double at_rad = hangs[static_cast<Eigen::Index>(i)];
      const auto& limits = chain.joints[i].limits;
      if (at_rad < limits.lower_rad + clear_rad || at_rad > limits.upper_rad - clear_rad) return false;
    }
    return true;
  };
  return is_free(setup.leader.arm.chain, leader_hangs) && is_free(setup.follower.arm.chain, follower_hangs);
}

ShippedPair unjudged(ShippedPair pair) {
  pair.setup.params.rig.support.raise_s = 0.0;
  return pair;
}

Arming arm_both(const ShippedPair& pair, Before before, const Beliefs& beliefs) {
  station::DescribedArms taken_for = pair.setup;
  taken_for.leader.arm.chain = beliefs.leader;
  taken_for.follower.arm.chain = beliefs.follower;
  taken_for.exact.induced.chain = beliefs.leader;
  auto made = station::arm_sites(pair.setup.params, taken_for, pair.leader_limits, pair.follower_limits);
  if (!made) return {};  // refused with a message
  station::JointSupervisedPair sites = *std::move(made);
  const bool hangs = before == Before::hangs;
  arming::ArmingDevice leader(pair.setup.leader.arm, hangs ? pair.leader_hangs : pair.setup.leader.start, before,
                              beliefs.leader_wiring, pair.leader_limits);
  arming::ArmingDevice follower(pair.setup.follower.arm, hangs ? pair.follower_hangs : pair.setup.follower.start,
                                before, beliefs.follower_wiring, pair.follower_limits);
  const auto& rig = pair.setup.params.rig;
  constexpr double begins_s = 0.04, spare_s = 4.0;
  const double lets_go_s = begins_s + std::max(rig.support.raise_s, rig.supervision.blend_s) + 0.2;
  const double longest_s =
      lets_go_s + spare_s +
      2.0 * static_cast<double>(pair.joints()) * (rig.supervision.probe.duration_s + rig.supervision.blend_s);
  return arming::arm_both(sites, leader, follower, pair.tick_s(), lets_go_s, longest_s);
}

}  // namespace tactus::sweeps
