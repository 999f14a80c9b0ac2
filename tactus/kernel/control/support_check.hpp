// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tactus::control {

/// What is wrong with the support of a joint: its weight by the model exceeds what its motor may give; the holding law
/// resists more than the model may be wrong by; the joint moved too far or too fast.
enum class SupportFault { none, weight, force, distance, speed };
constexpr auto enumerators(SupportFault) {
  return std::array{Enumerator{SupportFault::none, "none"}, Enumerator{SupportFault::weight, "weight"},
                    Enumerator{SupportFault::force, "force"}, Enumerator{SupportFault::distance, "distance"},
                    Enumerator{SupportFault::speed, "speed"}};
}

/// Holds a joint where it is while its support comes in, and judges the support by how the joint moves.
///
/// The holding law is a spring with a damper, F = −K·(x − x0) − B·v, where x0 is where the joint was when its support
/// began to come in. It gives nothing to a joint that rests. With it the joint obeys
///
///     m·a = s·G(x) − W(x) + R − friction − K·(x − x0) − B·v,
///
/// s being the share of the support G that has come in, W the true weight and R what a hand or a rest bears. While s
/// rises slowly against B/K and sqrt(m/K), what is left is quasi-static: E = K·(x − x0) + B·v is the force that support
/// and rest have too much. It is 0 for a right support of a joint that rests, hangs or is held, whatever s: R yields.
/// A wrong one shows as E long before the joint leaps, at a speed of (dE/dt)/K. Friction that breaks away lets the
/// joint go as far as E/K at once, and no farther.
///
/// The support is at fault where |E| exceeds `weight_share` of the weight by the model that has come in, and
/// `least_force_N` too; where the joint is `most_m` from x0; and where it is faster than `most_m_per_s`, by its drive
/// or by its position. While the support still comes in, and until a hand that holds the device has yielded, which it
/// does later than the weight goes, |E| may be twice that share, and `trial_force_N`.
///
/// Range: B·dt well below m, unless the drive runs the damper by itself; then the loop over the bus is stable for any m
/// if K·delay < B.
class SupportCheck {
 public:
  struct Params {
    double raise_s = 0.0;
    double stiffness_N_per_m = 0.0;
    double damping_N_s_per_m = 0.0;
    double weight_share = 0.3;
    double least_force_N = 0.0;
    double trial_force_N = 0.0;
    double weight_limit_N = 100.0;
    double most_m = 0.02;
    double most_m_per_s = 0.4;
    static constexpr auto fields() {
      return List{field("raise_s", &Params::raise_s, units::second, between(0.0, 60.0),
                        "Time in which the support comes in; 0 is that of blend_s, without holding law and judgement."),
                  field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, between(0.0, 1e4),
                        "Of the holding law."),
                  field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre,
                        between(0.0, 1e3), "Of the holding law, which the drive runs."),
                  field("weight_share", &Params::weight_share, units::none, positive_up_to(1.0),
                        "Share of the weight by which the support may be wrong."),
                  field("least_force_N", &Params::least_force_N, units::newton, between(0.0, 100.0),
                        "Force by which it may be wrong, whatever the weight."),
                  field("trial_force_N", &Params::trial_force_N, units::newton, between(0.0, 100.0),
                        "Force with which motors are tried; meanwhile it may be wrong by so much more."),
                  field("weight_limit_N", &Params::weight_limit_N, units::newton, positive_up_to(100.0),
                        "Weight above which nothing is powered."),
                  field("most_m", &Params::most_m, units::metre, positive_up_to(0.03), "Travel that is a fault."),
                  field("most_m_per_s", &Params::most_m_per_s, units::metre_per_second, positive_up_to(0.5),
                        "Speed that is a fault.")};
    }
  };
  struct Input {
    double position_m = 0.0;
    double velocity_m_per_s = 0.0;  ///< that the drive reports; 0 where it reports none
    double weight_N = 0.0;          ///< by the model, all of it
    double share = 0.0;             ///< of it that has come in
    bool rises = false;             ///< it still comes in, or just has
    bool judged = true;             ///< false: the law yields as friction does, and nothing is a fault
    bool tried = false;             ///< motors are tried meanwhile, with `trial_force_N` at most
    std::int64_t elapsed_ticks = 1;
  };
  using Output = SupportFault;

  static constexpr double trial_softness = 0.25;

  /// Errors: a value out of bounds; a servo rate below 70 Hz.
  static Result<SupportCheck> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    constexpr double cutoff_Hz = 30.0;
    const auto velocity = signal::FilteredDerivative::make({.cutoff_Hz = cutoff_Hz}, dt);
    if (!velocity) return velocity.error();
    return SupportCheck(params, *velocity);
  }

  /// Holds the joint where it is from now on. Real-time safe, as all below.
  void begin(double position_m) noexcept {
    anchor_m_ = began_m_ = position_m;
    bias_N_ = 0.0;
    softness_ = 1.0;
    speed_m_per_s_ = excess_N_ = moved_m_ = 0.0;
    derivative_.reset();
  }
  /// Travel counts from here.
  void count_from(double position_m) noexcept { began_m_ = position_m; }
  /// Motors are tried from now on: the spring gives what it gave, and is as soft as `trial_softness` states about here.
  /// A damper alone brings a joint back after the trial's two lobes; a spring would return it between them, which looks
  /// as if it moved the wrong way.
  void begin_trial(double position_m) noexcept {
    bias_N_ = spring_N(position_m);
    anchor_m_ = began_m_ = position_m;
    softness_ = trial_softness;
  }
  /// They are no more; the spring gives what it gives now, stiff again.
  void end_trial(double position_m) noexcept {
    const double now_N = spring_N(position_m);
    bias_N_ = 0.0;
    softness_ = 1.0;
    anchor_m_ = holds() ? position_m + now_N / params_.stiffness_N_per_m : position_m;
  }
  /// One reading of a joint that is held.
  SupportFault step(const Input& input) noexcept {
    const double measured =
        derivative_.step_after(input.position_m, static_cast<double>(std::max<std::int64_t>(input.elapsed_ticks, 1)));
    speed_m_per_s_ = std::fabs(input.velocity_m_per_s) > std::fabs(measured) ? input.velocity_m_per_s : measured;
    moved_m_ = input.position_m - began_m_;
    const double share = (input.rises ? 2.0 : 1.0) * params_.weight_share * input.share;
    const double least_N = input.rises ? std::max(params_.least_force_N, params_.trial_force_N) : params_.least_force_N;
    const double may_be_N = std::max(least_N, share * std::fabs(input.weight_N));
    if (!input.judged && holds()) {
      const double yields_m = std::min(may_be_N / params_.stiffness_N_per_m, params_.most_m);
      anchor_m_ = std::clamp(anchor_m_, input.position_m - yields_m, input.position_m + yields_m);
    }
    excess_N_ = params_.damping_N_s_per_m * input.velocity_m_per_s - spring_N(input.position_m);
    if (!input.judged || (input.tried && !holds())) return SupportFault::none;
    if (std::fabs(moved_m_) > params_.most_m) return SupportFault::distance;
    // The trial moves a joint at up to three quarters of `most_m_per_s`, which a position in coarse steps overstates.
    constexpr double trial_margin = 1.25, most_ever_m_per_s = 0.5;
    const double most_m_per_s =
        input.tried ? std::min(trial_margin * params_.most_m_per_s, most_ever_m_per_s) : params_.most_m_per_s;
    if (std::fabs(speed_m_per_s_) > most_m_per_s) return SupportFault::speed;
    // What a trial accelerates is in the excess, up to the force of the trial.
    const double most_N = may_be_N + (input.tried ? params_.trial_force_N : 0.0);
    return std::fabs(excess_N_) > most_N ? SupportFault::force : SupportFault::none;
  }

  /// Of the spring, in N, at the latest reading; the damper is the drive's.
  [[nodiscard]] double spring_N(double position_m) const noexcept {
    return bias_N_ + softness_ * params_.stiffness_N_per_m * (anchor_m_ - position_m);
  }
  [[nodiscard]] const Params& params() const noexcept { return params_; }
  [[nodiscard]] bool judges() const noexcept { return params_.raise_s > 0.0; }
  /// Whether there is a holding law. Without one travel and speed are judged alone, and not while motors are tried.
  [[nodiscard]] bool holds() const noexcept { return params_.stiffness_N_per_m > 0.0; }
  [[nodiscard]] double moved_m() const noexcept { return moved_m_; }
  [[nodiscard]] double speed_m_per_s() const noexcept { return speed_m_per_s_; }
  /// What the support has too much, in N, as the holding law shows it.
  [[nodiscard]] double excess_N() const noexcept { return excess_N_; }

 private:
  SupportCheck(const Params& params, const signal::FilteredDerivative& velocity)
      : params_(params), derivative_(velocity) {}

  Params params_;
  signal::FilteredDerivative derivative_;
  double anchor_m_ = 0.0;
  double bias_N_ = 0.0;    ///< of the spring, while motors are tried
  double softness_ = 1.0;  ///< of its stiffness, then
  double began_m_ = 0.0;
  double moved_m_ = 0.0;
  double speed_m_per_s_ = 0.0;
  double excess_N_ = 0.0;
};

}  // namespace tactus::control
