// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/probe_words.hpp>

namespace tactus::cli {

std::string words_of(const control::ProbeReport& found, const devices::RigJoint& joint) {
  const devices::JointWords& words = joint.words();
  const auto travel = [&words](double value) { return report::fixed(1e3 * value, 1) + " m" + words.position_unit; };
  const std::string force = report::fixed(found.force_N, 2) + " " + words.force_unit;
  const std::string begins = "; sign probe of " + joint.path + ": ";
  switch (found.verdict) {
    case control::ProbeVerdict::none:
    case control::ProbeVerdict::passed:
      return {};
    case control::ProbeVerdict::reversed:
      return begins + "it moved against the torque of its motor (" + force +
             "): correct the motor's wiring, its encoder or its driver; `sign` of the rig file turns both and does not "
             "help";
    case control::ProbeVerdict::still:
      return begins + "it moved by " + travel(found.moved_m) + " under " + force + ", and must move by " +
             travel(found.needed_m) +
             " both ways: let it move freely; if it is heavier or has more friction, raise the probe's most_force_N, "
             "or "
             "duration_s (of an arm: its torque in rig.probe_torque)";
    case control::ProbeVerdict::astray:
      return begins + "it moved by " + travel(found.moved_m) + " under " + force +
             (found.moved_m > found.most_m
                  ? ", beyond " + travel(found.most_m) +
                        ": if it is light, lower the probe's force_N, or hold it lightly"
                  : ", the same way for either sign: keep your hand off it until it is tested");
  }
  return {};
}

}  // namespace tactus::cli
