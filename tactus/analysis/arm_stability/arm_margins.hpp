// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/arm_stability/arm_loop.hpp>
#include <tactus/analysis/stability/margins.hpp>
#include <tactus/simulation/experiments/gain_limit.hpp>

#include <complex>
#include <span>

namespace tactus::arm_stability {

/// What moves no faster than this, turning, decaying or growing, is left to the operator and to friction, which the
/// loop has not: no pole so near to 1 is counted. An arm of more joints than its hand holds has one at 1, for it rests
/// at any elbow.
inline constexpr double persons_Hz = 1.0;

/// The pole of a loop that decays slowest or grows fastest, and what moves in it.
struct ArmMode {
  std::complex<double> pole;
  double drift_per_s = 0.0;  ///< how fast the fastest of what is left to the operator grows; below 0 it decays
  double frequency_Hz = 0.0;
  bool of_leader = false;  ///< which arm has more of the motion's energy
  int joint = 0;           ///< from 0: the one of that arm that has most of it
  double share = 0.0;      ///< that arm's, 0.5 to 1
};

/// The slowest mode at a force gain. Energy counts each joint by itself, by its diagonal of the mass matrix. Not
/// real-time safe.
ArmMode slowest_mode(const ArmLoop& loop, double force_gain);

/// Whether no pole grows that is counted. Not real-time safe.
bool stable(const ArmLoop& loop, double force_gain);

/// Where a search for a limit ends.
inline constexpr double lowest_arm_gain = 0.01, highest_arm_gain = 100.0;

/// The largest force gain up to which every one of some loops, one at least, is stable, to half a percent: by steps of
/// √2 and bisection (`experiments::find_gain_limit`).
experiments::GainLimit gain_limit(std::span<const ArmLoop> loops);

/// How far every joint's displayed torque may change at once, each by itself, in gain and phase, until a pole is on
/// the unit circle, at least: the balanced disk margin of several loops. α is 1/max μ(S − I/2) over frequency, S the
/// sensitivity where the torque is displayed, with the structured singular value's bound from above by scaling of the
/// joints (Osborne 1960): what it promises holds, and more may. Of a loop that is not stable α is 0.
/// Source: Seiler, Packard, Gahinet, An introduction to disk margins, IEEE Control Systems 40(5), 2020.
stability::DiskMargin disk_margin(const ArmLoop& loop, double force_gain);

}  // namespace tactus::arm_stability
