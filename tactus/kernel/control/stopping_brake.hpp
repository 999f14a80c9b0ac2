// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cmath>

namespace tactus::control {

/// Brings a device that nobody holds to rest by its motor, which may be what is wrong: F = −b·v until the device
/// is at rest, and no force from then on. Once it is faster by `gained_m_per_s` than when the brake began, this is no
/// brake, and there is no force either, until `reset`. So a motor or an encoder that works the wrong way adds about as
/// much to the speed and no more; one that gives nothing or sticks is left to whatever else stops it.
class StoppingBrake {
 public:
  struct Params {
    double damping_N_s_per_m = 3.0;
    static constexpr auto fields() {
      return List{field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre, non_negative,
                        "Force over speed; b·T must be well below the moving mass.")};
    }
  };
  using Input = double;   ///< velocity in m/s, measured
  using Output = double;  ///< force in N, in the direction of the velocity

  static constexpr double gained_m_per_s = 0.1;
  /// What is slower is at rest.
  static constexpr double stands_m_per_s = 0.005;

  static Result<StoppingBrake> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return StoppingBrake(params);
  }

  /// Once a tick. Real-time safe.
  double step(double velocity_m_per_s) noexcept {
    const double speed_m_per_s = std::fabs(velocity_m_per_s);
    if (!begun_) began_m_per_s_ = speed_m_per_s;
    begun_ = true;
    brakes_ = brakes_ && speed_m_per_s >= stands_m_per_s && speed_m_per_s <= began_m_per_s_ + gained_m_per_s;
    return brakes_ ? -params_.damping_N_s_per_m * velocity_m_per_s : 0.0;
  }
  /// As made: the next step begins to brake.
  void reset() noexcept { *this = StoppingBrake(params_); }

 private:
  explicit StoppingBrake(const Params& params) : params_(params) {}

  Params params_;
  bool begun_ = false;
  double began_m_per_s_ = 0.0;
  bool brakes_ = true;
};

}  // namespace tactus::control
