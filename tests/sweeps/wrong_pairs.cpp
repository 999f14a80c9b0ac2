// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <tests/sweeps/arming_bench.hpp>

namespace tactus::sweeps {

namespace {

using Model = arm::Chain::Params;
using signal::Random;

/// As many below 1 as above, over decades.
double factor(Random& random, double lower, double upper) {
  return std::exp(random.uniform(std::log(lower), std::log(upper)));
}
/// As drawn, where the pair can hang freely.
Before kept_up(Before drawn, const ShippedPair& pair) {
  return drawn == Before::hangs && !pair.hangs_freely() ? Before::held : drawn;
}
std::string rounded(double value) { return rounded_number(value); }

Model with_masses(Model model, double by) {
  for (auto& joint : model.joints) {
    arm::Body& body = joint.body;
    for (double* of : {&body.mass_kg, &body.xx_kg_m2, &body.yy_kg_m2, &body.zz_kg_m2, &body.xy_kg_m2, &body.xz_kg_m2,
                       &body.yz_kg_m2}) {
      *of *= by;
    }
  }
  return model;
}

/// As a URDF in other units: its inertias are mostly not converted.
Model with_lengths(Model model, double by) {
  for (auto& joint : model.joints) {
    for (double* of : {&joint.origin.x_m, &joint.origin.y_m, &joint.origin.z_m, &joint.body.centre_x_m,
                       &joint.body.centre_y_m, &joint.body.centre_z_m}) {
      *of *= by;
    }
  }
  return model;
}

/// Every mass and every number of a centre of mass wrong by up to `share`.
Model nearly_right(const Model& truth, Random random, double share) {
  Model model = truth;
  for (auto& joint : model.joints) {
    for (double* of : {&joint.body.mass_kg, &joint.body.centre_x_m, &joint.body.centre_y_m, &joint.body.centre_z_m}) {
      *of *= 1.0 + random.uniform(-share, share);
    }
  }
  return model;
}

/// Which of the two arms: the leader, the follower, or both.
struct Which {
  bool leader, follower;
  explicit Which(Random& random, bool same_urdf = false) {
    const auto drawn = random.bits() % 3;
    leader = same_urdf || drawn != 1;
    follower = same_urdf || drawn != 0;
  }
  [[nodiscard]] const char* words() const { return leader && follower ? "both" : leader ? "leader" : "follower"; }
};

}  // namespace

WrongPair wrong_pair(const std::vector<ShippedPair>& pairs, std::int64_t seed, std::size_t index) {
  constexpr std::size_t kinds = 4;
  Random random = Random(static_cast<std::uint64_t>(seed)).fork(index);
  const std::size_t kind = index % kinds, turn = index / kinds;
  WrongPair wrong;
  wrong.pair = turn % pairs.size();
  const ShippedPair& pair = pairs[wrong.pair];
  wrong.before = kept_up(static_cast<Before>(random.bits() % 3), pair);
  wrong.beliefs = truth_of(pair);
  Beliefs& beliefs = wrong.beliefs;
  const std::size_t nth = turn / pairs.size(), joints = pair.joints();
  const Which which(random, kind < 2 && !station::differs(pair.setup.params.arm));
  const auto change = [&](auto&& make) {
    if (which.leader) beliefs.leader = make(beliefs.leader);
    if (which.follower) beliefs.follower = make(beliefs.follower);
  };
  const auto wire = [&](auto&& make) {
    if (which.leader) make(beliefs.leader_wiring);
    if (which.follower) make(beliefs.follower_wiring);
  };
  if (kind == 0) {
    const double by = factor(random, 0.3, 10.0);
    change([by](const Model& model) { return with_masses(model, by); });
    wrong.words = "masses x " + rounded(by);
  } else if (kind == 1) {
    const double drawn = factor(random, 0.5, 1000.0);
    const double by = nth % 6 == 1 ? 100.0 : nth % 6 == 2 ? 1000.0 : drawn;
    change([by](const Model& model) { return with_lengths(model, by); });
    wrong.words = "lengths x " + rounded(by);
  } else if (kind == 2) {
    const std::size_t joint = nth % (joints - 1);
    wire([joint](Wiring& wiring) { std::swap(wiring.motor[joint], wiring.motor[joint + 1]); });
    wrong.words = "joints " + std::to_string(joint + 1) + " and " + std::to_string(joint + 2) + " swapped";
  } else {
    const std::size_t joint = nth % joints;
    wire([joint](Wiring& wiring) { wiring.sign[joint] = -1.0; });
    wrong.words = "joint " + std::to_string(joint + 1) + " reversed";
  }
  wrong.words += std::string(" (") + which.words() + "), " + std::string(name_of(wrong.before)) + ", " + pair.name;
  return wrong;
}

WrongPair nearly_right_pair(const std::vector<ShippedPair>& pairs, std::int64_t seed, std::size_t index, double share) {
  Random random = Random(static_cast<std::uint64_t>(seed)).fork(1'000'000 + index);
  WrongPair wrong;
  wrong.pair = index % pairs.size();
  const ShippedPair& pair = pairs[wrong.pair];
  wrong.before = kept_up(static_cast<Before>(index / pairs.size() % 3), pair);
  wrong.beliefs = truth_of(pair);
  const Random of_leader = random.fork(1), of_follower = random.fork(station::differs(pair.setup.params.arm) ? 2 : 1);
  wrong.beliefs.leader = nearly_right(wrong.beliefs.leader, of_leader, share);
  wrong.beliefs.follower = nearly_right(wrong.beliefs.follower, of_follower, share);
  wrong.words = rounded(100.0 * share) + " % wrong, " + std::string(name_of(wrong.before)) + ", " + pair.name;
  return wrong;
}

}  // namespace tactus::sweeps
