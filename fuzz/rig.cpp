// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/devices/rig/rig_edit.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>
#include <string_view>

using namespace tactus;
using devices::Rig;
using devices::RigJoint;
using devices::RigSide;

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

constexpr const char* name = "rig.toml";

/// What nobody who drives it looks at again.
void check_joint(const RigJoint& one) {
  const auto& joint = one.joint;
  demand(joint.sign == 1 || joint.sign == -1);
  demand(std::isfinite(joint.offset_rad) && joint.gear > 0.0 && std::isfinite(joint.gear));
  demand(joint.lower_rad < joint.upper_rad && std::isfinite(joint.upper_rad - joint.lower_rad));
  demand(joint.velocity_limit_rad_per_s > 0.0 && std::isfinite(joint.velocity_limit_rad_per_s));
  demand(!joint.gives_force || (joint.torque_limit_Nm > 0.0 && joint.torque_rate_limit_Nm_per_s > 0.0));
  const double most_Nm = joint.motor_torque_Nm(1e9);
  demand(std::isfinite(most_Nm) && std::isfinite(joint.motor_torque_Nm(-1e9)));
}

void check_side(const Rig& rig, const RigSide& side) {
  demand(!side.joints.empty() && side.joints.size() <= most_joints);
  demand(side.bus.motors.size() == side.joints.size() && !devices::check(side.bus));
  std::set<std::int64_t> motors;
  for (std::size_t i = 0; i < side.joints.size(); ++i) {
    const RigJoint& one = side.joints[i];
    demand(one.motor.id == side.bus.motors[i].id && motors.insert(one.motor.id).second);
    check_joint(one);
    const auto found = rig.sides(one.path);
    demand(found && !found->empty());
  }
}

/// A new offset is the one that is read then, or it is left to the person.
void check_edit(std::string_view text, const RigJoint& one) {
  constexpr double offset_rad = 0.25;
  const auto changed = devices::with_offset(text, name, {.joint = one.path, .offset_rad = offset_rad});
  if (!changed) return demand(changed.error().code == ErrorCode::inconsistent);
  const auto again = Rig::parse(*changed, name);
  demand(static_cast<bool>(again));
  const auto side = again->sides(one.path);
  demand(side && !side->empty());
  bool found = false;
  for (const RigJoint& joint : side->front()->joints) {
    found = found || (joint.path == one.path && joint.joint.offset_rad == offset_rad);
  }
  demand(found);
}

}  // namespace

/// The input is a rig file. What is refused is refused in words that name the file; what is accepted is what those who
/// drive it rely on. No port is opened.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);  // NOLINT: bytes are text here
  const auto rig = Rig::parse(text, name);
  if (!rig) {
    demand(!rig.error().message.empty() && rig.error().place.starts_with(name));
    return 0;
  }
  demand(!rig->pairs().empty() && rig->pairs().size() <= 2);
  for (const auto& pair : rig->pairs()) {
    for (const auto* side : {&pair.leader, &pair.follower}) {
      if (*side) check_side(*rig, **side);
    }
    if (!pair.leader || !pair.follower) continue;
    demand(pair.leader->joints.size() == pair.follower->joints.size());
    for (std::size_t i = 0; i < pair.leader->joints.size(); ++i) {
      demand(pair.leader->joints[i].name() == pair.follower->joints[i].name());
    }
  }
  const auto all = rig->sides();
  demand(all && !all->empty());
  check_edit(text, all->front()->joints.front());
  return 0;
}
