// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/devices/rig/rig_second.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/kernel/station/channel.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// A rig file's pair in virtual time: the sites, devices and joints of a program that drives it (`RigLoop`,
/// `MotorBusDevice`), before simulated motors whose position may be wrong.
namespace tactus::sweeps {

/// What is wrong with the position that a motor reports. Its velocity and torque stay true, but for the last.
enum class PositionFault {
  none,
  frozen,          ///< not a bit changes
  stuck,           ///< it stays within a count
  scaled_down,     ///< up to half of the travel
  scaled_up,       ///< one and a half times the travel to three times
  reversed,        ///< the travel counts the other way
  late,            ///< by 0.15 to 0.4 s
  wrong_velocity,  ///< the position is right and the reported velocity has the other sign
};
constexpr auto enumerators(PositionFault) {
  return std::array{
      Enumerator{PositionFault::none, "none"},           Enumerator{PositionFault::frozen, "frozen"},
      Enumerator{PositionFault::stuck, "stuck"},         Enumerator{PositionFault::scaled_down, "scaled-down"},
      Enumerator{PositionFault::scaled_up, "scaled-up"}, Enumerator{PositionFault::reversed, "reversed"},
      Enumerator{PositionFault::late, "late"},           Enumerator{PositionFault::wrong_velocity, "wrong-velocity"}};
}
inline constexpr std::size_t position_faults = 7;

/// A rig file with the experiment that drives it.
struct ShippedRig {
  std::string name;
  double rate_Hz = 500.0;
  devices::RigPair pair;                          ///< joints in the order of the sites
  Joints<control::ControlParams> control;         ///< where it is driven joint by joint
  station::LinkParams channel;                    ///< the same
  std::optional<experiments::ArmPairSetup> arms;  ///< where it is driven as two arms

  [[nodiscard]] std::size_t joints() const { return pair.leader->joints.size(); }
};
std::vector<ShippedRig> shipped_rigs();
/// The rig whose comparison of position and velocity is as loose as a file can make it, for the control of a sweep.
ShippedRig unjudged(ShippedRig rig);

/// One run.
struct PositionPlan {
  std::size_t rig = 0;
  PositionFault fault = PositionFault::none;
  bool of_leader = true;
  std::size_t joint = 0;
  std::uint64_t seed = 1;
  bool contact = false;      ///< the follower's joints meet end stops halfway
  double duration_s = 20.0;  ///< after it follows; with a fault the run ends once the site has released its side
};
/// Every fault at every joint of every rig, in turn, again with other numbers from then on.
PositionPlan position_plan(const std::vector<ShippedRig>& rigs, std::int64_t seed, std::size_t index);
/// How many that are until it starts over.
std::size_t position_plans(const std::vector<ShippedRig>& rigs);
std::string words_of(const std::vector<ShippedRig>& rigs, const PositionPlan& plan);

struct PositionOutcome {
  bool followed = false;  ///< both sites were active before the fault
  bool released = false;  ///< the faulty side's site released it; without a fault, either
  double travelled_rad =
      0.0;                  ///< of the motor, at its gear's output, from where it was when the fault began until then
  double ran_s = 0.0;       ///< while both were active
  devices::RigSecond last;  ///< what the program knows of it
};
PositionOutcome run(const ShippedRig& rig, const PositionPlan& plan);
std::string words_of(const PositionOutcome& outcome);

}  // namespace tactus::sweeps
