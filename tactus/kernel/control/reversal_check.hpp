// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tactus::control {

/// Whether a device gains speed against the force on it, as one does whose motor is wired the wrong way round, or whose
/// encoder counts backwards. By m·dv/dt = F_motor − F_resisting − friction a device that moves against the force on it
/// slows down: friction brakes it even more, and what else pushes it is in F_resisting, where a sensor measures that.
///
/// It is reversed where that force, F_motor − F_resisting, has opposed the motion with `force_N` or more for
/// `lasting_s`, and the speed then rises by `gained_m_per_s` above its lowest since. What the amplifier, the sensors
/// and the low-pass of the velocity still show the time before is over by then.
///
/// A hand may well push its handle against the displayed force, and a wall throws a slave back. Where no sensor
/// measures that (the tip's at a slave, the hand's at a master), only thresholds that neither can reach mean anything.
/// By default they are out of reach. After a long gap between two readings it counts for half of `lasting_s` at most:
/// one reading alone proves nothing.
class ReversalCheck {
 public:
  struct Params {
    double force_N = 200.0;
    double gained_m_per_s = 0.1;
    double lasting_s = 0.01;
    static constexpr auto fields() {
      return List{field("force_N", &Params::force_N, units::newton, positive_up_to(200.0),
                        "The check takes effect when the net force (motor force minus the resistance that a sensor "
                        "measures) is at least this. While the net force opposes the motion, the device must not gain "
                        "speed. Must be greater than friction plus the error of the sensor."),
                  field("gained_m_per_s", &Params::gained_m_per_s, units::metre_per_second, positive_up_to(100.0),
                        "Gain of speed against the net force at which the gate reports a fault."),
                  field("lasting_s", &Params::lasting_s, units::second, positive_up_to(1.0),
                        "Time for which the net force must oppose the motion before a gain of speed counts. Must be "
                        "longer than the delays of amplifier and sensors.")};
    }
  };
  struct Input {
    double net_N = 0.0;              ///< of the motor less what resists it, since the reading before
    double velocity_m_per_s = 0.0;   ///< measured, in the direction of the motor's force
    std::int64_t elapsed_ticks = 1;  ///< since the reading before
  };
  /// Whether the device is reversed.
  using Output = bool;

  static Result<ReversalCheck> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return ReversalCheck(params, dt);
  }

  /// Real-time safe.
  bool step(const Input& input) noexcept {
    const double speed = std::fabs(input.velocity_m_per_s);
    const bool opposed =
        std::fabs(input.net_N) >= params_.force_N && (input.net_N > 0.0) == (input.velocity_m_per_s < 0.0);
    opposed_s_ =
        opposed ? opposed_s_ + std::min(dt_s_ * static_cast<double>(input.elapsed_ticks), longest_gap_s_) : 0.0;
    slowest_m_per_s_ = opposed_s_ > params_.lasting_s ? std::min(slowest_m_per_s_, speed) : speed;
    return speed - slowest_m_per_s_ >= params_.gained_m_per_s;
  }
  /// At rest.
  void reset() noexcept { slowest_m_per_s_ = opposed_s_ = 0.0; }

 private:
  ReversalCheck(const Params& params, Seconds dt)
      : params_(params), dt_s_(dt.value), longest_gap_s_(std::max(dt.value, 0.5 * params.lasting_s)) {}

  Params params_;
  double dt_s_;
  double longest_gap_s_;
  double opposed_s_ = 0.0;        ///< how long the force has opposed the motion
  double slowest_m_per_s_ = 0.0;  ///< since it has for `lasting_s`
};

}  // namespace tactus::control
