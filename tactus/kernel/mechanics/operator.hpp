// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/cable_chain.hpp>
#include <tactus/kernel/signal/delay_line.hpp>
#include <tactus/kernel/signal/low_pass.hpp>
#include <tactus/kernel/signal/sections.hpp>

#include <algorithm>

namespace tactus::mechanics {

/// The arithmetic of an `Operator`, but for the reaction time. A template on the scalar, and made of nothing else: a
/// sweep runs it in lanes.
template <class Scalar>
struct OperatorMotion {
  /// A point on the unit circle; the tremor turns it by a fixed angle a tick, which needs no sine in the loop.
  struct Phase {
    Scalar cosine{}, sine{};
  };
  /// Where the hand wants the handle during this tick: `position_m` at its start, moving at `velocity_m_per_s`.
  struct Aim {
    Scalar position_m{}, velocity_m_per_s{};
  };

  Scalar dt_s{};
  Scalar correction_gain_per_s{};
  Scalar tremor_amplitude_m{};
  Phase tremor_turn, tremor;
  Scalar correction_m{};
  signal::FirstOrderSection<Scalar> low_pass;

  /// The error that the operator will feel a reaction time later.
  Scalar felt(const Scalar& handle_position_m, const Scalar& path_m) noexcept {
    return low_pass.step(handle_position_m - path_m);
  }
  /// `error_m` is what `felt` gave a reaction time ago.
  Aim step(const Scalar& path_m, const Scalar& path_at_next_tick_m, const Scalar& error_m) noexcept {
    const Scalar correction_velocity = -correction_gain_per_s * error_m;
    const Scalar tremor_now_m = tremor_amplitude_m * tremor.sine;
    tremor = {.cosine = tremor.cosine * tremor_turn.cosine - tremor.sine * tremor_turn.sine,
              .sine = tremor.sine * tremor_turn.cosine + tremor.cosine * tremor_turn.sine};
    const Scalar tremor_next_m = tremor_amplitude_m * tremor.sine;
    const Aim aim{
        .position_m = path_m + tremor_now_m + correction_m,
        .velocity_m_per_s = (path_at_next_tick_m - path_m + tremor_next_m - tremor_now_m) / dt_s + correction_velocity};
    correction_m = correction_m + correction_velocity * dt_s;
    return aim;
  }
};

/// The operator at the master, as a plant. Three things at once:
///
/// - a passive impedance, the grip: a linear spring and damper from the handle to where the hand wants to be
///   (paper A, Table I). The chain of the master carries it; here it is only a parameter.
/// - the intended path with physiological tremor on it (8 to 12 Hz; Elble and Koller, *Tremor*, 1990).
/// - slow correction: the operator sees or feels the handle off the path and shifts the aim, as an integrator on the
///   error, low-passed near 5 Hz and a reaction time late (paper A, Sec. VI: active compensation up to about 5 Hz,
///   reaction about 100 ms).
///
/// Steps once per servo tick. Between ticks the aim moves at constant velocity: the velocity steps that this makes
/// move the handle by less than 1 nm, because the grip smooths them over about 1 ms.
class Operator {
 public:
  struct Correction {
    double gain_per_s = 4.0;
    double bandwidth_Hz = 5.0;
    double reaction_time_s = 0.1;
    static constexpr auto fields() {
      return List{
          field("gain_per_s", &Correction::gain_per_s, units::per_second, between(0.0, 8.0),
                "Speed of the correction per metre of error; 0 is off. Above 8 an operator would oscillate."),
          field("bandwidth_Hz", &Correction::bandwidth_Hz, units::hertz, between(0.1, 20.0),
                "Corner frequency of the first-order low-pass on the position error that the operator corrects."),
          field("reaction_time_s", &Correction::reaction_time_s, units::second, between(0.0, 0.4),
                "Time from an error to the start of its correction.")};
    }
  };

  /// A grip that gets firmer or lighter during a run: stiffness and damping go from what they are to `factor` times
  /// that, along a minimum-jerk curve.
  struct GripChange {
    double factor = 1.0;
    double start_s = 0.0;
    double duration_s = 0.1;
    static constexpr auto fields() {
      return List{field("factor", &GripChange::factor, units::none, between(0.05, 20.0),
                        "Stiffness and damping of the grip after the change divided by those before; 1: no change."),
                  field("start_s", &GripChange::start_s, units::second, non_negative,
                        "Start of the change, from the start of the run."),
                  field("duration_s", &GripChange::duration_s, units::second, non_negative, "Duration of the change.")};
    }
    /// The factor in force `time_s` after the start of the run, exactly 1 before the change.
    [[nodiscard]] double at(double time_s) const noexcept {
      const double share =
          duration_s > 0.0 ? std::clamp((time_s - start_s) / duration_s, 0.0, 1.0) : (time_s < start_s ? 0.0 : 1.0);
      return 1.0 + (factor - 1.0) * share * share * share * (10.0 + share * (6.0 * share - 15.0));
    }
  };

  struct Params {
    LinearSpring::Params grip{.stiffness_N_per_m = 40.0, .damping_N_s_per_m = 23.0};
    GripChange grip_change;
    Correction correction;
    double tremor_amplitude_m = 5e-5;
    double tremor_frequency_Hz = 10.0;
    double tremor_phase_cycles = 0.0;
    static constexpr auto fields() {
      return List{field("grip", &Params::grip, "Passive impedance of hand and arm at the handle (paper A, Table I)."),
                  field("grip_change", &Params::grip_change, "A grip that changes during the run."),
                  field("correction", &Params::correction, "Slow correction of the handle's position."),
                  field("tremor_amplitude_m", &Params::tremor_amplitude_m, units::metre, between(0.0, 0.005),
                        "Amplitude of physiological tremor on the intended path."),
                  field("tremor_frequency_Hz", &Params::tremor_frequency_Hz, units::hertz, between(1.0, 30.0),
                        "Frequency of the tremor."),
                  field("tremor_phase_cycles", &Params::tremor_phase_cycles, units::cycles, between(0.0, 1.0),
                        "Phase of the tremor at the start.")};
    }
  };

  struct Input {
    double path_m = 0.0;               ///< the intended path at this tick
    double path_at_next_tick_m = 0.0;  ///< and at the next
    double handle_position_m = 0.0;    ///< where the handle is at this tick
  };

  using Output = OperatorMotion<double>::Aim;

  static Result<Operator> make(const Params& params, Seconds dt);
  Output step(const Input& input) noexcept;
  void reset() noexcept;

  [[nodiscard]] const OperatorMotion<double>& motion() const noexcept { return motion_; }
  [[nodiscard]] std::size_t reaction_ticks() const noexcept { return reaction_.delay_ticks(); }

  /// Longest reaction time in ticks: 0.4 s at 20 kHz.
  static constexpr std::size_t longest_reaction_ticks = 8000;

 private:
  using Reaction = signal::DelayLine<double, longest_reaction_ticks>;

  Operator(const OperatorMotion<double>& motion, const Reaction& reaction)
      : start_(motion), motion_(motion), reaction_(reaction) {}

  OperatorMotion<double> start_;
  OperatorMotion<double> motion_;
  Reaction reaction_;
};

}  // namespace tactus::mechanics
