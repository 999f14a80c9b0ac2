// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/drive_law.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::control {

/// What is wrong with a measured position alongside the velocity that its drive reports.
enum class MotionFault { none, contradicted, repeated };

/// Whether the position of a joint moves as its drive reports it to move. Two checks, both on new measurements alone:
///
/// **Contradiction.** Over the travel x and the reported velocity v it keeps a sum of their difference for each sign,
///
///     S ← max(S ± (Δx − v̄·Δt) − (0.1·|v̄| + velocity_error)·Δt, floor)
///
/// v̄ being the mean of v over the gap Δt between two measurements (a CUSUM: E. S. Page, Biometrika 41, 1954). A
/// position that is frozen, stuck, scaled, reversed or late lets one of them grow with the travel; it is contradicted
/// above `disagreement_m`. The velocity may lag by the filter of its drive, so `lag_s` times the range of v since the
/// sum was at its floor is allowed alongside that.
///
/// **Age.** An answer is stamped when it arrives, and was measured at any time since the one before. So the difference
/// of one measurement is uncertain by |v| times the gap before it: that much is allowed, and is what the floor is below
/// zero. On a busy host an answer is late, or many come in one burst; the next ones bring the difference back to
/// where it was. The allowance shrinks over the next readings, slowly while they come in a burst. What a gap is longer
/// than 10 ms proves nothing.
///
/// **Repetition.** A drive that reports the same position, velocity and force bit for bit, while the motor's force went
/// on by `repeated_share` of its limit, reports nothing that was measured. This counts once the reported force has
/// changed since the last `reset`, so a drive that reports none is not judged.
///
/// It knows no model and no controller. It applies where a drive reports a velocity of its own: where a driver derives
/// it from the position, both agree whatever happens.
class MotionCheck {
 public:
  struct Params {
    double disagreement_m = 0.04;
    double velocity_error_m_per_s = 0.02;
    double lag_s = 0.006;
    double velocity_step_m_per_s = 0.0;
    static constexpr auto fields() {
      return List{
          field("disagreement_m", &Params::disagreement_m, units::metre, positive_up_to(0.1),
                "Largest difference between the change of the measured position and the integral of the reported "
                "velocity."),
          field("velocity_error_m_per_s", &Params::velocity_error_m_per_s, units::metre_per_second, positive_up_to(1.0),
                "Tolerated constant error of the reported velocity. If velocity_step_m_per_s is larger, that value "
                "applies."),
          field("lag_s", &Params::lag_s, units::second, positive_up_to(0.1),
                "Delay with which the drive reports a change of its velocity."),
          field("velocity_step_m_per_s", &Params::velocity_step_m_per_s, units::metre_per_second, between(0.0, 10.0),
                "Resolution of the velocity that the drive reports. A device whose drives report a velocity sets this "
                "value itself. 0: the drive reports no velocity, and there is no check.")};
    }
  };
  struct Input {
    double position_m = 0.0;
    DriveReport tells;
    double acted_N = 0.0;        ///< on the motor since the reading before
    double force_limit_N = 0.0;  ///< of the motor; of one that gives none, repetition is not judged
    double between_s = 0.0;      ///< since the measurement before
  };
  using Output = MotionFault;

  /// What was compared when a fault was found.
  struct Evidence {
    double travelled_m = 0.0;  ///< by the position
    double reported_m = 0.0;   ///< by the velocity
    double time_s = 0.0;       ///< in which they did
    double force_N = 0.0;      ///< change of the motor's force that moved no reading; 0 for a contradiction
  };

  /// How much of the speed may be wrong for good.
  static constexpr double tolerated_share = 0.1;
  /// Change of the force over its limit that must show in a reading, how long, and in how many readings.
  static constexpr double repeated_share = 0.1;
  static constexpr double repeated_s = 0.03;
  static constexpr int repeated_readings = 5;

  static Result<MotionCheck> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return MotionCheck(params);
  }

  /// One new measurement. Real-time safe.
  MotionFault step(const Input& input) noexcept {
    if (params_.velocity_step_m_per_s <= 0.0) return MotionFault::none;
    if (repeats(input)) return MotionFault::repeated;
    return contradicts(input) ? MotionFault::contradicted : MotionFault::none;
  }
  /// The next measurement is the first.
  void reset() noexcept { *this = MotionCheck(params_); }

  [[nodiscard]] const Evidence& evidence() const noexcept { return evidence_; }

 private:
  /// One sign of the difference, and what it was compared over.
  struct Sum {
    double sum_m = 0.0;
    double travelled_m = 0.0, reported_m = 0.0, time_s = 0.0;
    double slowest_m_per_s = 0.0, fastest_m_per_s = 0.0;
  };

  explicit MotionCheck(const Params& params)
      : params_(params), error_m_per_s_(std::max(params.velocity_error_m_per_s, params.velocity_step_m_per_s)) {}

  bool contradicts(const Input& input) noexcept {
    const double velocity_m_per_s = input.tells.velocity_m_per_s;
    const double travelled_m = input.position_m - position_m_;
    const double mean_m_per_s = 0.5 * (velocity_m_per_s_ + velocity_m_per_s);
    const double gap_s = std::max(input.between_s, 0.0);
    // Between two measurements nothing is known but the velocities at both ends.
    const double speed_m_per_s = std::max(std::fabs(velocity_m_per_s), std::fabs(velocity_m_per_s_));
    const bool first = !started_;
    started_ = true;
    position_m_ = input.position_m;
    const double change_m_per_s = std::fabs(velocity_m_per_s - std::exchange(velocity_m_per_s_, velocity_m_per_s));
    if (first) {
      late_s_ = longest_lateness_s;
      ahead_.sum_m = behind_.sum_m = -speed_m_per_s * late_s_;
      return false;
    }
    const double before_s = late_s_;
    late_s_ = std::max(gap_s, (gap_s < burst_s ? kept_in_burst : kept_lateness) * late_s_);
    const double uncertain_m = speed_m_per_s * late_s_;
    const double tolerated_m = (tolerated_share * std::fabs(mean_m_per_s) + error_m_per_s_) * gap_s +
                               speed_m_per_s * std::max(gap_s - longest_gap_s, 0.0) +
                               change_m_per_s * std::max(before_s - longest_gap_s, 0.0);
    bool found = false;
    for (const double sign : {1.0, -1.0}) {
      Sum& own = sign > 0.0 ? ahead_ : behind_;
      own.sum_m += sign * (travelled_m - mean_m_per_s * gap_s) - tolerated_m;
      own.travelled_m += travelled_m;
      own.reported_m += mean_m_per_s * gap_s;
      own.time_s += gap_s;
      own.slowest_m_per_s = std::min(own.slowest_m_per_s, velocity_m_per_s);
      own.fastest_m_per_s = std::max(own.fastest_m_per_s, velocity_m_per_s);
      if (own.sum_m <= 0.0) {
        own = {.sum_m = std::max(own.sum_m, -uncertain_m),
               .slowest_m_per_s = velocity_m_per_s,
               .fastest_m_per_s = velocity_m_per_s};
        continue;
      }
      const double lag_m = params_.lag_s * (own.fastest_m_per_s - own.slowest_m_per_s);
      if (own.sum_m <= params_.disagreement_m + lag_m + uncertain_m) continue;
      evidence_ = {.travelled_m = own.travelled_m, .reported_m = own.reported_m, .time_s = own.time_s};
      found = true;
    }
    return found;
  }

  bool repeats(const Input& input) noexcept {
    if (input.force_limit_N < harmless_N) return false;
    const bool same = started_ && input.position_m == position_m_ && input.tells.velocity_m_per_s == velocity_m_per_s_;
    if (!same || input.tells.force_N != force_N_) {
      alive_ = alive_ || (started_ && input.tells.force_N != force_N_);
      force_N_ = input.tells.force_N;
      acted_N_ = input.acted_N;
      same_s_ = 0.0;
      same_readings_ = 0;
      return false;
    }
    const double went_N = input.acted_N - acted_N_;
    if (!alive_ || std::fabs(went_N) < repeated_share * input.force_limit_N) {
      same_s_ = 0.0;
      same_readings_ = 0;
      return false;
    }
    same_s_ += std::clamp(input.between_s, 0.0, 0.5 * repeated_s);
    if (++same_readings_ < repeated_readings || same_s_ < repeated_s) return false;
    evidence_ = {.time_s = same_s_, .force_N = went_N};
    return true;
  }

  /// Over a longer gap the velocity may have been anything up to its larger end, and what it changed by after a late
  /// answer it may have done at once.
  static constexpr double longest_gap_s = 0.01;
  /// Of the first answer, of which no gap states how late it is; a device does not respond before that.
  static constexpr double longest_lateness_s = 0.05;
  /// Answers that are closer to one another waited in a buffer.
  static constexpr double burst_s = 0.0003;
  static constexpr double kept_in_burst = 0.97, kept_lateness = 0.7;  ///< from one reading to the next
  static constexpr double harmless_N = 1e-6;

  Params params_;
  double error_m_per_s_;
  bool started_ = false;
  double position_m_ = 0.0, velocity_m_per_s_ = 0.0;
  double late_s_ = 0.0;  ///< by which the stamp of the newest answers may be wrong
  Sum ahead_, behind_;
  bool alive_ = false;  ///< the reported force has changed
  double force_N_ = 0.0, acted_N_ = 0.0;
  double same_s_ = 0.0;
  int same_readings_ = 0;
  Evidence evidence_;
};

}  // namespace tactus::control
