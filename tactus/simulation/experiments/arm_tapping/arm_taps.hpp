// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace tactus::experiments {

/// One tap: what the operator does, and the model that the controller has.
struct ArmTap {
  mechanics::MinimumJerk path;  ///< of the follower's tool, outward from where it began
  double wall_m = 0.0;
  ArmModelParams model_params;
  ArmPlantErrors plant_errors = {};
};

/// A tap as it went.
struct ArmTrace {
  struct Contact {
    double force_N = 0.0;  ///< of the wall
    ArmSnapshot snapshot;
  };
  std::vector<ArmRecord> records;   ///< of each tick
  std::optional<Contact> pressing;  ///< `pressing_after_s` after the first touch; none where it did not come to that
};
/// The impact is over by then, and what is displayed has moved the hand.
inline constexpr double pressing_after_s = 0.05;

/// A contact as it went, without comparison.
struct ArmContact {
  bool touched = false;
  bool rings = false;  ///< after 150 ms some 50 ms hold more above 15 Hz than a sine of a tenth of the peak does
  double peak_N = 0.0;
  double steady_N = 0.0;    ///< mean of the last 100 ms
  double residual_N = 0.0;  ///< above 15 Hz, RMS over the last 100 ms
  double felt_share = 0.0;  ///< of the contact force above 15 Hz, RMS, that the hand's spring and damper feel
  double lost_s = 0.0;      ///< longest time without contact that begins 150 ms after the first touch or later
};

/// Judges a tap whose first touch was at record `first_touch`.
ArmContact judge_arm_contact(std::span<const ArmRecord> records, std::size_t first_touch, double tick_s);

struct ArmTapResult {
  ArmContact contact;
  /// Presses 1.6 times as hard at its peak, 1 N more, or twice as hard in the end, as at gain 0.
  bool ran_away = false;
  bool diverged = false;
  bool rings_at_gain_0 = false;  ///< the same tap without display, whose ringing no gain is the cause of
  [[nodiscard]] bool settled() const { return contact.touched && !contact.rings && !ran_away && !diverged; }
};

/// Compares it with the same tap at gain 0.
ArmTapResult judge_arm_tap(const ArmContact& contact, bool diverged, const ArmContact& without_display);

/// A reach of 200 mm outward in 0.75 s, of the follower's tool, that meets nothing.
struct ArmReach {
  double lag_m = 0.0;          ///< farthest of the follower's tool from where the leader leads it
  double effort_N = 0.0;       ///< of the hand's spring and damper along the reach, RMS
  double false_force_N = 0.0;  ///< what the follower sends, as a force at the leader's tool (`ArmSnapshot`), RMS
  double drift_m = 0.0;        ///< farthest that cancellation moves the command from where the leader is
};

/// An operator who holds the leader still for `ArmTappingTask::hold_s`, in the air.
struct ArmHold {
  double force_N = 0.0;  ///< of the hand's spring and damper, RMS
  double drift_m = 0.0;  ///< farthest of either tool from where it began
};

/// What an operator accepts: beyond it the verdict names the figure.
inline constexpr double most_lost_s = 0.05;
inline constexpr double most_hold_N = 1.0, most_hold_m = 0.003;
/// So large a share of the taps settles in a combination that settles; so large a share may lose contact.
inline constexpr double settles_share = 0.95;

/// The ensemble of one combination.
class ArmTaps {
 public:
  /// Errors: those of `set_up_arm_pair`; `inconsistent` for empty ranges; what a pair refuses.
  static Result<ArmTaps> make(const ArmTappingParams& params, const std::filesystem::path& folder);
  static Result<ArmTaps> make(const ArmTappingParams& params, const urdf::Urdfs& urdfs);

  [[nodiscard]] std::size_t size() const { return taps_.size(); }
  [[nodiscard]] double tick_s() const { return 1.0 / setup_.params.servo.rate_Hz; }
  [[nodiscard]] const ArmPairSetup& setup() const { return setup_; }
  [[nodiscard]] const ArmTap& tap(std::size_t at) const { return taps_[at]; }
  /// Runs a tap twice, at the gain and at gain 0; with `trace`, leaves the first there.
  ArmTapResult run(std::size_t tap, ArmTrace* trace = nullptr) const;
  /// A tap at gain 0: what one that may run away is compared with.
  [[nodiscard]] ArmContact run_without_display(std::size_t tap) const;
  /// Runs a tap at this gain.
  ArmTapResult run_at(double gain, std::size_t tap, const ArmContact& without_display, ArmTrace* trace = nullptr) const;
  [[nodiscard]] ArmReach reach() const;
  /// How many taps `hold` is tried with: one if no errors are drawn that it could show, else up to four.
  [[nodiscard]] std::size_t holds() const;
  /// With the errors of a tap.
  [[nodiscard]] ArmHold hold(std::size_t tap) const;

 private:
  struct Contact {
    ArmContact contact;
    bool diverged = false;
  };
  [[nodiscard]] Contact run_once(const ArmPairSetup& setup, const ArmTap& tap, ArmTrace* trace) const;

  ArmPairSetup setup_;
  std::vector<ArmTap> taps_;
};

/// An ensemble in a few numbers; medians over the taps.
struct ArmTappingMetrics {
  std::size_t taps = 0;
  double settled_fraction = 0.0;
  double rings_fraction = 0.0;
  double ran_away_fraction = 0.0;  ///< diverged ones too
  double peak_force_N = 0.0;
  double steady_force_N = 0.0;
  double residual_rms_N = 0.0;
  double felt_share = 0.0;
  double never_touched_fraction = 0.0;
  double rings_at_gain_0_fraction = 0.0;
  double lost_fraction = 0.0;   ///< of the taps that lose contact for longer than `most_lost_s`
  double longest_lost_s = 0.0;  ///< of all taps
  ArmHold hold = {};            ///< the largest of each
  ArmReach reach = {};
};
ArmTappingMetrics summarise(const std::vector<ArmTapResult>& taps, const ArmReach& reach,
                            const std::vector<ArmHold>& held);

}  // namespace tactus::experiments
