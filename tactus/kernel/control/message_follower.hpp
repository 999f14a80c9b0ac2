// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tactus::control {

/// What a site assumes of the other, while messages fail and when they come again.
///
/// - A message that is fresh every tick passes unchanged, bit for bit.
/// - In silence a position continues at its estimated velocity for `extrapolation_s`; then velocity, force and wave
/// decay
///   with the time constant `decay_s`, so a position goes no farther than v·(extrapolation + decay).
/// - Where the site does not follow, the position stays where it was and all else fades to zero at the rate below.
/// - What then comes again differs from what is given. The difference is kept and closed at a bounded rate, so neither
///   the end of a silence or of a stall nor the start of following makes a step.
///
/// The running total of energy counts only what was sent while following, so a restarted site, which counts from zero,
/// takes none away.
class MessageFollower {
 public:
  struct Params {
    double extrapolation_s = 0.01;
    double decay_s = 0.02;
    double catch_up_m_per_s = 0.05;
    double catch_up_N_per_s = 20.0;
    static constexpr auto fields() {
      return List{
          field("extrapolation_s", &Params::extrapolation_s, units::second, between(0.0, 0.1),
                "Time without packets for which the received position is extrapolated at its last velocity and the "
                "other received values stay constant."),
          field("decay_s", &Params::decay_s, units::second, positive_up_to(1.0),
                "Time constant with which velocity, force and wave decay after extrapolation_s."),
          field("catch_up_m_per_s", &Params::catch_up_m_per_s, units::metre_per_second, positive_up_to(10.0),
                "Largest speed, in addition to the received motion, at which the site's copy of the received position "
                "catches up after a gap."),
          field("catch_up_N_per_s", &Params::catch_up_N_per_s, units::newton_per_second, positive_up_to(1e5),
                "As catch_up_m_per_s, for a received force in N/s, a received velocity in m/s per s, and a received "
                "wave in square roots of watts per s.")};
    }
  };
  struct Input {
    Arrival arrival{};  ///< the newest that counts
    bool following = false;
    std::int64_t elapsed_ticks = 1;
  };
  using Output = Arrival;

  static Result<MessageFollower> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return MessageFollower(params, dt);
  }

  /// Once a tick. Real-time safe.
  Arrival step(const Input& input) noexcept;
  /// Is at `position_m`, everything else zero.
  void settle(double position_m) noexcept;
  void reset() noexcept { settle(0.0); }

  /// How far the position that is given differs from what was sent.
  [[nodiscard]] double gap_m() const noexcept { return gap_.position_m; }

 private:
  MessageFollower(const Params& params, Seconds dt)
      : params_(params), dt_s_(dt.value), decay_(std::exp(-dt.value / params.decay_s)) {}

  void learn(const Message& told) noexcept;
  void lapse(std::int64_t elapsed_ticks) noexcept;
  void resume() noexcept;

  Params params_;
  double dt_s_;
  double decay_;  ///< in a tick
  Message told_;
  Message out_;
  Message gap_;  ///< of what is given over what is sent; its energy is not used
  double velocity_m_per_s_ = 0.0;
  double ahead_m_ = 0.0;  ///< extrapolated so far
  double share_ = 0.0;    ///< of what was sent last that still counts
  double silence_s_ = 0.0;
  double last_energy_J_ = 0.0;
  bool follows_ = false;
  bool learnt_ = false;  ///< a message came since following began
};

}  // namespace tactus::control
