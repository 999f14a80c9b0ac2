// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/support_words.hpp>

#include <cmath>

namespace tactus::cli {

namespace {

/// Less than this share of the motor's limit is next to no weight.
constexpr double next_to_none = 0.02;

std::string cause_of(const control::SupportFinding& found) {
  if (std::fabs(found.weight_N) < next_to_none * found.limit_N) {
    return "; by the URDF it bears next to no weight: joints are swapped or count the other way (sign, motor), or the "
           "URDF's gravity or zero positions are not this arm's";
  }
  // The holding law resists what is too much; a joint that was too fast may not have come far.
  const double along = found.excess_N != 0.0 ? found.excess_N : found.speed_m_per_s;
  if (along * found.weight_N > 0.0) {
    return ", against gravity: the URDF overstates the weight (units, masses), or a joint counts the other way (sign) "
           "or is swapped with another";
  }
  return ", as gravity pulls: the URDF understates the weight (a tool that it does not have), the arm was released "
         "before "
         "its motors carried it, or a joint counts the other way (sign) or is swapped with another";
}

}  // namespace

std::string words_of(const control::SupportFinding& found, const devices::RigJoint& joint) {
  using control::SupportFault;
  if (found.fault == SupportFault::none) return {};
  const devices::JointWords& words = joint.words();
  const auto force = [&words](double value) {
    return report::fixed(std::fabs(value), std::fabs(value) < 10.0 ? 2 : 0) + " " + words.force_unit;
  };
  if (found.fault == SupportFault::weight) {
    return "; " + joint.path + " would bear a gravity torque of " + force(found.weight_N) +
           " by the URDF, and its limit is " + force(found.limit_N) +
           ": not powered; look at the URDF's units (m, kg), masses and zero positions, or raise torque_limit_Nm, the "
           "gate's force_limit_N or the URDF's effort";
  }
  return "; " + joint.path + " moved by " + report::fixed(1e3 * found.moved_m, 1) + " m" + words.position_unit +
         " at " + report::fixed(found.speed_m_per_s, 2) + " " + words.position_unit + "/s with " +
         report::fixed(100.0 * found.share, 0) + " % of gravity compensation, whose torque there is wrong by about " +
         force(found.excess_N) + " of " + force(found.weight_N) + cause_of(found) + "; all joints were released";
}

}  // namespace tactus::cli
