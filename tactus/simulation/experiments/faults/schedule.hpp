// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>

/// What happens when in a run of `FaultRun`, in s: of the run, or after the end of the fault.
namespace tactus::experiments::fault_schedule {

/// When the operator at the sites presses what, before the fault.
inline constexpr double align_s = 0.05, arm_s = 0.10, press_s = 0.15, button_s = 0.01;
/// Until when who waits for the motors to be tried keeps the hand still.
inline constexpr double still_until_s = 0.5;
/// After the fault: what is looked at first, then cleared, aligned, armed, pressed.
inline constexpr double look_after_s = 0.25, clear_after_s = look_after_s + 0.02, realign_after_s = 0.29,
                        rearm_after_s = 0.34, repress_after_s = 0.40;
inline constexpr double settled_after_s = 0.75, end_after_s = 0.9;
inline constexpr double resume_watch_s = 0.02;

/// When a site is in the state that a bad number is to meet.
inline double bad_number_at_s(control::SiteState state) {
  using control::SiteState;
  switch (state) {
    case SiteState::configure:
      return 0.5 * align_s;
    case SiteState::align:
      return 0.5 * (align_s + arm_s);
    case SiteState::armed:
      return 0.5 * (arm_s + press_s);
    case SiteState::active:
    case SiteState::hold:
    case SiteState::fault:
      break;
  }
  return 0.9;
}
/// What brings a site into `hold` or `fault` before that.
inline constexpr double prelude_s = 0.6, prelude_length_s = 0.15;

}  // namespace tactus::experiments::fault_schedule
