#pragma once

#include <tactus/core/element.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/link/datagram.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace tactus::link {

/// What a site makes of the other's message when messages fail: it keeps the last one for a while, then lets its
/// force, velocity and wave decay to zero, and in hold keeps the position alone. When messages count again, each
/// number goes from where it stands to what is told no faster than its rate limit, and follows freely once it is there:
/// resuming makes no step.
///
///     share = clamp((hold_after − silence) / (hold_after − stale_after), 0, 1) while active, 0 in hold
///
/// The running total of energy counts only what is sent while following, so a restarted site, which counts from zero,
/// takes none away.
class Following {
 public:
  struct Params {
    double stale_after_s = 0.02;
    double hold_after_s = 0.1;
    double catch_up_m_per_s = 0.1;
    double catch_up_m_per_s2 = 2.0;
    double catch_up_N_per_s = 20.0;
    double catch_up_wave_per_s = 20.0;
    static constexpr auto fields() {
      return std::tuple{
          field("stale_after_s", &Params::stale_after_s, units::second, positive_up_to(10.0),
                "Silence after which what was told last begins to decay."),
          field("hold_after_s", &Params::hold_after_s, units::second, positive_up_to(10.0),
                "Silence after which the site holds, until it is armed again; longer than stale_after_s."),
          field("catch_up_m_per_s", &Params::catch_up_m_per_s, units::metre_per_second, positive_up_to(1.0),
                "Fastest change of the told position while catching up."),
          field("catch_up_m_per_s2", &Params::catch_up_m_per_s2, Unit{"m/s^2", "_m_per_s2"}, positive_up_to(100.0),
                "Fastest change of the told velocity while catching up."),
          field("catch_up_N_per_s", &Params::catch_up_N_per_s, units::newton_per_second, positive_up_to(1e4),
                "Fastest change of the told force while catching up."),
          field("catch_up_wave_per_s", &Params::catch_up_wave_per_s, units::per_second, positive_up_to(1e4),
                "Fastest change of a told wave variable, in square roots of watts, while catching up.")};
    }
  };
  struct Input {
    control::Arrival arrival;
    double silence_s = 0.0;
    Standing standing = Standing::hold;
  };
  using Output = control::Arrival;

  static Result<Following> make(const Params& params, Seconds dt) { return make(params, dt, {}); }
  /// In hold at `initial`.
  static Result<Following> make(const Params& params, Seconds dt, const control::Message& initial) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    if (params.stale_after_s >= params.hold_after_s) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "stale_after_s",
                   .message = format_number(params.stale_after_s) + " s must be less than hold_after_s, " +
                              format_number(params.hold_after_s) + " s: lower it or raise hold_after_s",
                   .place = {}};
    }
    return Following(params, dt, initial);
  }

  /// What the site shall take the other to have told. Real-time safe.
  Output step(const Input& input) noexcept {
    const bool active = input.standing == Standing::active;
    const double share =
        active ? std::clamp((hold_after_s_ - input.silence_s) / (hold_after_s_ - stale_after_s_), 0.0, 1.0) : 0.0;
    if (share < 1.0) following_ = {};
    const control::Message& told = input.arrival.message;
    const double told_position_m = active ? told.position_m : message_.position_m;
    follow(message_.position_m, told_position_m, 0);
    follow(message_.velocity_m_per_s, active ? share * told.velocity_m_per_s : 0.0, 1);
    follow(message_.force_N, active ? share * told.force_N : 0.0, 2);
    follow(message_.wave, active ? share * told.wave : 0.0, 3);
    if (active && was_active_) message_.energy_J += told.energy_J - last_energy_J_;
    last_energy_J_ = told.energy_J;
    was_active_ = active;
    return {.message = message_, .fresh = active && input.arrival.fresh};
  }

  /// Back in hold where it was made.
  void reset() noexcept {
    message_ = initial_;
    following_ = {};
    last_energy_J_ = 0.0;
    was_active_ = false;
  }

  /// Whether everything that is told is followed freely.
  [[nodiscard]] bool caught_up() const noexcept {
    return std::all_of(following_.begin(), following_.end(), [](bool one) { return one; });
  }

 private:
  Following(const Params& params, Seconds dt, const control::Message& initial)
      : stale_after_s_(params.stale_after_s),
        hold_after_s_(params.hold_after_s),
        largest_steps_{params.catch_up_m_per_s * dt.value, params.catch_up_m_per_s2 * dt.value,
                       params.catch_up_N_per_s * dt.value, params.catch_up_wave_per_s * dt.value},
        initial_(initial),
        message_(initial) {}

  void follow(double& value, double target, std::size_t which) noexcept {
    const double largest = largest_steps_[which];
    following_[which] = following_[which] || std::fabs(target - value) <= largest;
    value = following_[which] ? target : std::clamp(target, value - largest, value + largest);
  }

  double stale_after_s_;
  double hold_after_s_;
  std::array<double, 4> largest_steps_;
  control::Message initial_;
  control::Message message_;
  std::array<bool, 4> following_{};
  double last_energy_J_ = 0.0;
  bool was_active_ = false;
};

}  // namespace tactus::link
