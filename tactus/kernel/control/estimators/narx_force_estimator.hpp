// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/force_estimator.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::control {

/// What a term of a NARX model can be a product of, by number: 0 the one; 1 to 6 the difference of the positions i − 1
/// and i lags old, over its scale; 7 to 9 the model's own output i − 6 lags before, over its limit. Differences show
/// lagged positions apart far better than positions do, and hold wherever the slave is; a slave with a spring of its
/// own needs another model.
struct NarxVariables {
  static constexpr std::size_t most_differences = 6, most_outputs = 3;
  static constexpr std::size_t first_difference = 1, first_output = 7, count = 10;
};

/// coefficient·v_1·v_2·v_3, each v by its number.
struct NarxTerm {
  double coefficient_N = 0.0;
  std::int64_t variable_1 = 0;
  std::int64_t variable_2 = 0;
  std::int64_t variable_3 = 0;
  static constexpr auto fields() {
    return List{field("coefficient_N", &NarxTerm::coefficient_N, units::newton, between(-1e9, 1e9),
                      "Force where each variable is at its scale; 0 drops the term."),
                field("variable_1", &NarxTerm::variable_1, between(0, 9), "First factor; 0 is the one."),
                field("variable_2", &NarxTerm::variable_2, between(0, 9), "Second factor."),
                field("variable_3", &NarxTerm::variable_3, between(0, 9), "Third factor.")};
  }
};

/// A fixed number of terms, so that the model is a value; those with coefficient 0 are left out.
struct NarxTerms {
  static constexpr std::size_t most = 12;
  NarxTerm term_0{}, term_1{}, term_2{}, term_3{}, term_4{}, term_5{};
  NarxTerm term_6{}, term_7{}, term_8{}, term_9{}, term_10{}, term_11{};
  static constexpr auto fields() {
    using T = NarxTerms;
    return List{field("term_0", &T::term_0, "Term."),   field("term_1", &T::term_1, "Term."),
                field("term_2", &T::term_2, "Term."),   field("term_3", &T::term_3, "Term."),
                field("term_4", &T::term_4, "Term."),   field("term_5", &T::term_5, "Term."),
                field("term_6", &T::term_6, "Term."),   field("term_7", &T::term_7, "Term."),
                field("term_8", &T::term_8, "Term."),   field("term_9", &T::term_9, "Term."),
                field("term_10", &T::term_10, "Term."), field("term_11", &T::term_11, "Term.")};
  }
  [[nodiscard]] std::array<NarxTerm, most> all() const noexcept {
    return {term_0, term_1, term_2, term_3, term_4, term_5, term_6, term_7, term_8, term_9, term_10, term_11};
  }
  /// The first `most` of `terms`.
  static NarxTerms of(std::span<const NarxTerm> terms) noexcept;
};

/// How a NARX model sees the slave: filters, lags and scales.
struct NarxScales {
  double cutoff_Hz = 100.0;
  double lag_s = 0.002;
  double difference_scale_m = 1e-4;
  double force_limit_N = 10.0;
  static constexpr auto fields() {
    using S = NarxScales;
    return List{field("cutoff_Hz", &S::cutoff_Hz, units::hertz, positive,
                      "Butterworth low-pass on position and command, below half the sample rate."),
                field("lag_s", &S::lag_s, units::second, positive,
                      "From one lag to the next; rounded to samples, 1 to 64 of them."),
                field("difference_scale_m", &S::difference_scale_m, units::metre, positive,
                      "Scale of each difference of lagged positions."),
                field("force_limit_N", &S::force_limit_N, units::newton, between(1e-9, 1e9),
                      "The model's output saturates here, and this is its scale.")};
  }
};

/// The past that a NARX model looks at: variables at every tick. Shared by the estimator and by the fit, which puts the
/// measured output where the estimator puts the model's.
class NarxMemory {
 public:
  using Variables = std::array<double, NarxVariables::count>;

  /// Errors: `cutoff_Hz` or `lag_s` that do not fit the sample rate.
  static Result<NarxMemory> make(const NarxScales& scales, double actuator_gain, Seconds dt);

  /// The variables at this sample. Every one is held within ±1000 scales. Real-time safe.
  Variables see(const SlaveMotionSample& sample) noexcept;
  /// Filtered force of the actuator at the sample seen last, in N.
  [[nodiscard]] double command_N() const noexcept { return command_N_; }
  /// The output that belongs to the sample seen last; once a tick, after `see`. Real-time safe.
  void remember(double output_N) noexcept;
  void reset() noexcept;
  [[nodiscard]] std::size_t lag_ticks() const noexcept { return lag_ticks_; }

 private:
  static constexpr std::size_t most_lag_ticks = 64;
  static constexpr std::size_t capacity = most_lag_ticks * NarxVariables::most_differences + 1;

  NarxMemory(const signal::SecondOrderFilter& filter, const NarxScales& scales, double actuator_gain,
             std::size_t lag_ticks)
      : position_filter_(filter),
        command_filter_(filter),
        scales_(scales),
        actuator_gain_(actuator_gain),
        lag_ticks_(lag_ticks) {}

  signal::SecondOrderFilter position_filter_;
  signal::SecondOrderFilter command_filter_;
  NarxScales scales_;
  double actuator_gain_;
  std::size_t lag_ticks_;
  std::array<double, capacity> positions_m_{};
  std::array<double, capacity> outputs_N_{};
  std::size_t now_ = 0;
  double command_N_ = 0.0;
  bool started_ = false;
};

/// Environment force from a polynomial NARX model of free motion, run as an inverse model:
///
///     û_k = Σ θ_i·v_{i1}·v_{i2}·v_{i3},    F_e = û − Q·K_a·u,
///
/// the variables made of low-passed positions at several lags and of the model's own earlier outputs û, never of the
/// measured command: a model that sees the command before would follow it and call no force foreign. With output
/// variables this is a free run of a nonlinear recursion, which no condition on θ proves stable: û saturates at
/// ±`force_limit_N`, so the estimate is bounded whatever θ is, and a saturated model is wrong, not unsafe. Terms and
/// scales come from `identification::fit_narx`. Starts at rest wherever the first sample is.
/// Source: S. Chen, S. A. Billings, W. Luo, Orthogonal least squares methods and their application to non-linear system
/// identification, Int. J. Control 50(5), 1989.
class NarxForceEstimator {
 public:
  struct Params {
    double actuator_gain = 1.0;
    NarxScales scales{};
    NarxTerms terms{};
    static constexpr auto fields() {
      return List{field("actuator_gain", &Params::actuator_gain, units::none, any_finite,
                        "K_a: force in N per unit of the command."),
                  field("scales", &Params::scales, "Filters, lags and scales."),
                  field("terms", &Params::terms, "The polynomial.")};
    }
  };
  using Input = SlaveMotionSample;
  using Output = ForceEstimate;

  static Result<NarxForceEstimator> make(const Params& params, Seconds dt);

  /// Once a tick. Real-time safe.
  Output step(const Input& sample) noexcept;
  void reset() noexcept { memory_.reset(); }

 private:
  struct Product {
    double coefficient_N = 0.0;
    std::array<std::size_t, 3> variables{};
  };
  NarxForceEstimator(const NarxMemory& memory, double limit_N) : memory_(memory), limit_N_(limit_N) {}
  NarxMemory memory_;
  double limit_N_;
  std::size_t count_ = 0;
  std::array<Product, NarxTerms::most> products_{};
};

}  // namespace tactus::control
