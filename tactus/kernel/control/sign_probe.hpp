// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace tactus::control {

/// What a sign probe found: nothing yet; that the device follows its motor; that it goes the other way; that it does
/// not move, either way or both; that it goes too far, or the same way whatever the force.
enum class ProbeVerdict { none, passed, reversed, still, astray };
constexpr auto enumerators(ProbeVerdict) {
  return std::array{Enumerator{ProbeVerdict::none, "none"}, Enumerator{ProbeVerdict::passed, "passed"},
                    Enumerator{ProbeVerdict::reversed, "reversed"}, Enumerator{ProbeVerdict::still, "still"},
                    Enumerator{ProbeVerdict::astray, "astray"}};
}

/// What the latest trial saw, kept after it has ended.
struct ProbeReport {
  ProbeVerdict verdict = ProbeVerdict::none;
  double force_N = 0.0;   ///< peak of the latest force
  double moved_m = 0.0;   ///< farthest from home under it, either way
  double needed_m = 0.0;  ///< least_m
  double most_m = 0.0;
};

/// Gives a motor a small known force and looks where the device goes, before anybody relies on it. The force has lobes
/// of one length, (1 − cos)/2 in shape, with the signs + − 0 − +: out and back, a pause, and the same the other way.
/// The impulse of each half is zero, so a free mass m is at rest after it, F·T²/(50 m) away after the first, T being
/// `duration_s`, and at home after the second.
///
/// In each half the device must go `least_m` the right way before it goes as far the wrong way. Whatever it is that is
/// moved, mass, spring or damper, its first motion is along the force; where it goes later is not, so it is not looked
/// at. Beyond `most_m` the force ends at once.
///
/// A joint that is heavier, or rubs more, needs a larger force. If the device does not move, or moves the same way
/// whatever the force, as one that leans on its friction does under a small force, the trial is repeated with twice the
/// force, up to `most_force_N`. So a free mass moves by less than 4·least_m in the trial that it passes,
/// whatever its size, unless the first force is too large for it. The largest free mass that can pass is
/// most_force_N·T²/(50·least_m).
///
/// The device must be free to move both ways, and not be moved by anything else by `least_m` in half of `duration_s`.
class SignProbe {
 public:
  struct Params {
    double force_N = 0.0;
    double most_force_N = 0.0;
    double duration_s = 0.1;
    double least_m = 1e-4;
    double most_m = 0.01;
    static constexpr auto fields() {
      return List{field("force_N", &Params::force_N, units::newton, between(0.0, 100.0),
                        "Peak force of the test of a motor on arming. Must be greater than the friction of the device. "
                        "0: no test."),
                  field("most_force_N", &Params::most_force_N, units::newton, between(0.0, 100.0),
                        "Largest test force. If the device does not move, the test is repeated with twice the force, "
                        "up to this value and the gate's force limit. 0: one test only."),
                  field("duration_s", &Params::duration_s, units::second, positive_up_to(5.0),
                        "Duration of one test, both directions together."),
                  field("least_m", &Params::least_m, units::metre, positive_up_to(0.1),
                        "Distance that the device must move with the force, in each direction. Must be several counts "
                        "of its encoder."),
                  field("most_m", &Params::most_m, units::metre, positive_up_to(1.0),
                        "Distance beyond which the test ends at once. Must be greater than least_m.")};
    }
  };
  struct Input {
    bool probing = false;            ///< the trial begins when this rises and is given up when it falls
    double position_m = 0.0;         ///< measured, in the direction of the force
    std::int64_t elapsed_ticks = 1;  ///< since the step before
  };
  /// The force in N for the motor.
  using Output = double;

  /// Errors: `inconsistent` for a `most_m` that is not above `least_m`, and for a `most_force_N` below `force_N`.
  static Result<SignProbe> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    if (params.most_m <= params.least_m) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "most_m",
                   .message = rounded_number(params.most_m) + " m must be more than least_m, " +
                              rounded_number(params.least_m) + " m: raise it or lower least_m",
                   .place = {}};
    }
    if (params.most_force_N > 0.0 && params.most_force_N < params.force_N) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "most_force_N",
                   .message = rounded_number(params.most_force_N) + " N must be at least force_N, " +
                              rounded_number(params.force_N) + " N: raise it, lower force_N, or write 0 for one trial",
                   .place = {}};
    }
    return SignProbe(params, dt);
  }

  /// How long it takes at most: every trial, until the force is `most_force_N`.
  static double longest_s(const Params& params) noexcept {
    double trials = 1.0;
    for (double force_N = params.force_N; force_N > 0.0 && force_N < params.most_force_N; force_N *= 2.0) trials += 1.0;
    return trials * params.duration_s;
  }

  /// Real-time safe.
  double step(const Input& input) noexcept {
    if (!input.probing) {
      reset();
      return 0.0;
    }
    if (verdict_ != ProbeVerdict::none) return 0.0;
    if (!begun_) {
      begin(input.position_m);
      report_ = {.needed_m = params_.least_m, .most_m = params_.most_m};
    } else {
      time_s_ += dt_s_ * static_cast<double>(input.elapsed_ticks);
    }
    look(input.position_m);
    return verdict_ == ProbeVerdict::none ? force_N() : 0.0;
  }
  /// No trial.
  void reset() noexcept {
    verdict_ = ProbeVerdict::none;
    begun_ = turned_ = false;
    went_ = {};
    time_s_ = home_m_ = turn_m_ = 0.0;
    peak_N_ = params_.force_N;
  }

  /// Of the trial under way; none until it is over.
  [[nodiscard]] ProbeVerdict verdict() const noexcept { return verdict_; }
  /// Of that trial, or of the one before if none is under way.
  [[nodiscard]] const ProbeReport& report() const noexcept { return report_; }

 private:
  SignProbe(const Params& params, Seconds dt)
      : params_(params), dt_s_(dt.value), lobe_s_(params.duration_s / 5.0), peak_N_(params.force_N) {}

  void begin(double position_m) noexcept {
    home_m_ = turn_m_ = position_m;
    time_s_ = 0.0;
    went_ = {};
    turned_ = false;
    begun_ = true;
  }

  void look(double position_m) noexcept {
    const bool second = time_s_ >= 3.0 * lobe_s_;
    if (second && !turned_) {
      turn_m_ = position_m;
      turned_ = true;
    }
    const double moved_m = second ? turn_m_ - position_m : position_m - home_m_;
    int& went = went_[second ? 1 : 0];
    if (went == 0 && std::fabs(moved_m) >= params_.least_m) went = moved_m > 0.0 ? 1 : -1;
    report_.force_N = peak_N_;
    report_.moved_m = time_s_ == 0.0 ? 0.0 : std::max(report_.moved_m, std::fabs(position_m - home_m_));
    if (std::fabs(position_m - home_m_) > params_.most_m) {
      verdict_ = went_[0] < 0 && went_[1] <= 0 ? ProbeVerdict::reversed : ProbeVerdict::astray;
    } else if (time_s_ >= params_.duration_s) {
      const ProbeVerdict found = judge();
      const bool is_open = found == ProbeVerdict::still || found == ProbeVerdict::astray;
      if (is_open && peak_N_ < params_.most_force_N) {
        peak_N_ = std::min(2.0 * peak_N_, params_.most_force_N);
        begin(position_m);
        return;
      }
      verdict_ = found;
    }
    report_.verdict = verdict_;
  }

  [[nodiscard]] ProbeVerdict judge() const noexcept {
    const auto [first, second] = went_;
    if (first + second == 2) return ProbeVerdict::passed;
    if (first + second < 0) return ProbeVerdict::reversed;
    return first != second && first * second != 0 ? ProbeVerdict::astray : ProbeVerdict::still;
  }

  [[nodiscard]] double force_N() const noexcept {
    constexpr std::array signs{1.0, -1.0, 0.0, -1.0, 1.0};
    const double lobes = time_s_ / lobe_s_;
    const double sign = signs[std::min(static_cast<std::size_t>(lobes), signs.size() - 1)];
    return sign * peak_N_ * 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * lobes));
  }

  Params params_;
  double dt_s_;
  double lobe_s_;
  double peak_N_;  ///< of the trial under way
  ProbeReport report_;
  ProbeVerdict verdict_ = ProbeVerdict::none;
  bool begun_ = false;
  bool turned_ = false;        ///< the second half has begun
  std::array<int, 2> went_{};  ///< in each half: 1 with the force, −1 against it, 0 neither so far
  double time_s_ = 0.0;
  double home_m_ = 0.0;
  double turn_m_ = 0.0;  ///< where the second half began
};

}  // namespace tactus::control
