// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tactus::control {

/// What is wrong with a measured position.
enum class EncoderFault { none, jump, frozen };
constexpr auto enumerators(EncoderFault) {
  return std::array{Enumerator{EncoderFault::none, "none"}, Enumerator{EncoderFault::jump, "jump"},
                    Enumerator{EncoderFault::frozen, "frozen"}};
}

/// Whether a measured position can be true.
///
/// A jump: |x(k) − x(k−1)| > v_max · t, t being the time between the two measurements. A spike is one, a counter that
/// wraps is one, and so is the return. A freeze: for `frozen_after_s` without a break there was a force that must
/// move the device, and not one count came. A device may go and come back between two readings, so a long gap between
/// them counts for at most half of that time. Such a force is
///
/// - a motor's force that is `frozen_force_N` or more away from what it was at the last count. A device that rests, or
///   presses with a steady force, is not frozen, so this shows only once the force works. It must stay away: a hand
///   that turns around holds a device still through the short pulses of a chattering contact;
/// - where a sensor reports what resists the motor, a difference of `unbalanced_force_N` or more between the two. What
///   friction cannot hold must move, however slowly the force changes.
///
/// Without model or controller: it knows the readings and the force that the gate let through. Range: v_max · T should
/// be well above one count; `unbalanced_force_N` above friction and the error of the sensor.
class EncoderCheck {
 public:
  struct Params {
    double fastest_m_per_s = 100.0;
    double frozen_force_N = 20.0;
    double unbalanced_force_N = 200.0;
    double frozen_after_s = 0.01;
    static constexpr auto fields() {
      return List{
          field("fastest_m_per_s", &Params::fastest_m_per_s, units::metre_per_second, positive_up_to(100.0),
                "Fastest possible motion. A difference between two readings that needs a faster motion is a jump."),
          field("frozen_force_N", &Params::frozen_force_N, units::newton, positive_up_to(200.0),
                "If the motor's force stays at least this far from its value at the last count for frozen_after_s, and "
                "the encoder's reading does not change, the encoder is frozen."),
          field("unbalanced_force_N", &Params::unbalanced_force_N, units::newton, positive_up_to(200.0),
                "Only with a force sensor at the tip or the hand. If the motor's force and the sensor's force differ "
                "by at least this much for frozen_after_s and the reading does not change, the encoder is frozen."),
          field("frozen_after_s", &Params::frozen_after_s, units::second, positive_up_to(1.0),
                "Time for which the reading must stay unchanged, with frozen_force_N or unbalanced_force_N exceeded, "
                "before the encoder counts as frozen.")};
    }
  };
  struct Input {
    double position_m = 0.0;
    double acted_N = 0.0;            ///< on the motor since the reading before
    double unbalanced_N = 0.0;       ///< what of it nothing known resists; 0 where nobody measures that
    std::int64_t elapsed_ticks = 1;  ///< since the reading before
    double older_ticks = 0.0;        ///< by how much that one was older at its tick than this one is now
  };
  using Output = EncoderFault;

  static Result<EncoderCheck> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return EncoderCheck(params, dt);
  }

  /// One reading, which must be finite. After a jump the reading before stays the measure. Real-time safe.
  EncoderFault step(const Input& input) noexcept {
    const double between_ticks = static_cast<double>(input.elapsed_ticks) + input.older_ticks;
    if (!started_ || input.position_m != position_m_) {
      if (started_ && std::fabs(input.position_m - position_m_) > farthest_m_ * between_ticks)
        return EncoderFault::jump;
      started_ = true;
      position_m_ = input.position_m;
      counted_N_ = input.acted_N;
      still_s_ = 0.0;
      return EncoderFault::none;
    }
    const bool must_move = std::fabs(input.acted_N - counted_N_) >= frozen_force_N_ ||
                           std::fabs(input.unbalanced_N) >= unbalanced_force_N_;
    const double gap_s = std::clamp(dt_s_ * between_ticks, 0.0, longest_gap_s_);
    still_s_ = must_move ? still_s_ + gap_s : 0.0;
    return still_s_ >= frozen_after_s_ ? EncoderFault::frozen : EncoderFault::none;
  }

  /// The next reading is assumed.
  void reset() noexcept {
    started_ = false;
    position_m_ = 0.0;
    counted_N_ = still_s_ = 0.0;
  }

 private:
  EncoderCheck(const Params& params, Seconds dt)
      : farthest_m_(params.fastest_m_per_s * dt.value),
        frozen_force_N_(params.frozen_force_N),
        unbalanced_force_N_(params.unbalanced_force_N),
        frozen_after_s_(params.frozen_after_s),
        longest_gap_s_(std::max(dt.value, 0.5 * params.frozen_after_s)),
        dt_s_(dt.value) {}

  double farthest_m_;  ///< in a tick
  double frozen_force_N_;
  double unbalanced_force_N_;
  double frozen_after_s_;
  double longest_gap_s_;
  double dt_s_;
  bool started_ = false;
  double position_m_ = 0.0;
  double counted_N_ = 0.0;  ///< the force at the last count
  double still_s_ = 0.0;    ///< since there is a force that must move the device
};

}  // namespace tactus::control
