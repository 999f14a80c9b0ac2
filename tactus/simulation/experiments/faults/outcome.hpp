// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/units.hpp>
#include <tactus/kernel/core/signals.hpp>

#include <cstdint>
#include <optional>

/// What came of a run with a fault.
namespace tactus::experiments {

/// What a fault did at one site to whoever holds the handle or is at the tool, from its first tick until the operator
/// clears it. Truths, whatever the sensors report.
struct SiteHarm {
  double given_J = 0.0;
  double speed_m_per_s = 0.0;
  double strayed_m = 0.0;
  double peak_force_N = 0.0;
  double release_s = 0.0;
  double pressing_N = 0.0;
  double drive_step_N = 0.0;
  static constexpr auto signals() {
    return List{
        observed("given_J", &SiteHarm::given_J, units::joule, "", "", "the motor gave it",
                 "Largest rise of the energy that the motor gave."),
        observed("speed_m_per_s", &SiteHarm::speed_m_per_s, units::metre_per_second, "", "", "",
                 "Fastest of the handle or the tool."),
        observed("strayed_m", &SiteHarm::strayed_m, units::metre, "", "", "",
                 "Farthest of it beyond the ends of the path on which the operator leads it."),
        observed("peak_force_N", &SiteHarm::peak_force_N, units::newton, "", "", "",
                 "Largest between the hand and the handle, or the tool and the wall."),
        observed("release_s", &SiteHarm::release_s, units::second, "", "", "",
                 "From the moment when no site was active until the motor gave no force for good."),
        observed("pressing_N", &SiteHarm::pressing_N, units::newton, "", "", "",
                 "Largest of it that lasts: low-passed over 0.1 s."),
        observed("drive_step_N", &SiteHarm::drive_step_N, units::newton, "", "", "",
                 "Largest change in a control cycle of what the motor really gives, except for the fault's first.")};
  }
};

/// What a fault did to two arms besides: truths of both, from its first tick until the operator clears it.
struct ArmHarm {
  double fastest_joint_share = 0.0;
  double sank_m = 0.0;
  double fell_m = 0.0;
  double moved_rad = 0.0;
  double leapt_rad_per_s = 0.0;
  bool had_power = false;  ///< either arm
  bool named = false;      ///< of sites that differ: the key, with both values
  static constexpr auto signals() {
    return List{
        observed("fastest_joint_share", &ArmHarm::fastest_joint_share, units::none, "", "", "",
                 "Fastest joint of an arm that has power, over the velocity limit of its gate."),
        observed("sank_m", &ArmHarm::sank_m, units::metre, "", "", "down",
                 "How far a tool that nobody holds sank while its site promised gravity compensation and did not "
                 "follow."),
        observed("fell_m", &ArmHarm::fell_m, units::metre, "", "", "down",
                 "How far a tool went down once its drives had no power."),
        observed("moved_rad", &ArmHarm::moved_rad, arm::units::radian, "", "", "",
                 "Where the model is wrong: farthest of a joint from where it lay until its site released it."),
        observed("leapt_rad_per_s", &ArmHarm::leapt_rad_per_s, arm::units::radian_per_second, "", "", "",
                 "Where the model is wrong: fastest of a joint until then.")};
  }
};

/// What a witness saw that is outside of both sites: it reads what reaches the motors, and remembers when each
/// packet was sent. It shares no code with what it judges.
struct FaultOutcome {
  std::int64_t not_finite = 0;             ///< forces at a motor that were no numbers
  std::int64_t stale_applied = 0;          ///< packets applied that were too old, or older than one before
  std::int64_t steps_above_rate = 0;       ///< changes of a motor's force in a tick above the rate limit
  std::int64_t forces_above_limit = 0;     ///< of a motor
  std::int64_t active_without_arming = 0;  ///< times a site followed again by itself
  double peak_force_N = 0.0;               ///< at either motor
  double given_J = 0.0;                    ///< largest rise of the energy that the master's motor gave in the whole run
  bool became_active = false;              ///< before the fault
  bool active_in_fault = false;            ///< both sites, while it lasted
  bool stopped = false;                    ///< a site left `active` after the fault began
  double time_to_stop_s = 0.0;             ///< from the begin of the fault until no site was active
  double master_followed_s = 0.0, slave_followed_s = 0.0;  ///< the same of each site by itself; 0 if it never was
  double release_s = 0.0;  ///< from both in a hold or fault until their motors gave less than a small force for good
  std::int64_t detection_ticks = -1;  ///< from the begin of the fault to a latched fault or a hold; -1 is never
  bool left_workspace = false;        ///< a device was a tenth beyond where its gate latches a fault, whatever it read
  bool active_at_end = false;         ///< both, after clearing and arming where that was needed
  double resume_step_N = 0.0;   ///< largest change of a force in a tick, from arming to 20 ms after following began
  double fault_N = 0.0;         ///< largest force, slowly, by which the fault made a motor or a force sensor wrong
  double winding_warmth = 0.0;  ///< of a motor without cooling; above 1 it is damaged
  SiteHarm master{}, slave{};
  std::optional<ArmHarm> arms = std::nullopt;  ///< of two arms alone
};

}  // namespace tactus::experiments
