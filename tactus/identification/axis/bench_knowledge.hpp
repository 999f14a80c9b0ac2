// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/bench_model.hpp>
#include <tactus/kernel/core/units.hpp>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// What has been found of a bench so far, how well, and how one finds more.
namespace tactus::identification {

/// The parameters of a bench that identification looks for, in the order in which they are found.
enum class BenchVariable {
  amplifier_gain,
  amplifier_offset,
  amplifier_bandwidth,
  amplifier_lag,
  motor_mass,
  motor_friction,
  cable_stiffness,
  cable_damping,
  drum_mass,
  drum_friction,
  linkage_stiffness,
  linkage_hysteretic_fraction,
  linkage_slip_deflection,
  linkage_damping,
  handle_mass,
  operator_stiffness,
  operator_damping,
  operator_correction,
  operator_reaction,
  operator_sight,
};
inline constexpr std::size_t bench_variables = 20;

/// Half of an `interval_95` in standard deviations.
inline constexpr double normal_95 = 1.96;

/// A parameter as an operator reads it.
struct FoundParameter {
  std::string name;  ///< dotted, with the suffix of its unit: `motor.mass_kg`
  std::string unit;
  double value = 0.0;
  std::array<double, 2> interval_95{};
  /// The interval reaches no further than a tenth of the value either way (for the amplifier's offset: than 5 mN).
  bool determined = false;
};

/// One run of one program, for a fit.
struct BenchExperiment {
  std::string title;
  Assembly assembly = Assembly::motor;
  MotorProgram program;
  RigRun run;
  int steps_per_tick = 1;
  double lower_Hz = 0.0;  ///< of what it excites, for figures; 0 for what is no sweep
  double upper_Hz = 0.0;
  double deviation_m = 1.0;   ///< what a position is expected to be off, divides the weight of a fit
  double high_pass_Hz = 0.0;  ///< only what is faster counts in a fit; 0 counts all
};

/// What a measurement counts for in a fit: the reciprocal of what it is expected to be off. 0 leaves it out.
struct MeasurementWeights {
  double position_per_m = 0.0;
  double current_per_N = 0.0;
};

/// Values so far with the joint covariance of all that is known.
class BenchKnowledge {
 public:
  /// `motor.mass_kg` and so on, also the parameter of an error.
  static const char* name(BenchVariable variable);

  /// Nothing is known; fits start from these values.
  explicit BenchKnowledge(const BenchParams& start);

  [[nodiscard]] const BenchParams& params() const { return params_; }
  [[nodiscard]] bool knows(BenchVariable variable) const;
  /// Covariance of the variables `a` and `b` of fits: logarithms of what is greater than 0.
  [[nodiscard]] double covariance(BenchVariable a, BenchVariable b) const;
  /// From now on a fit draws this variable to its present value, which is known to `share` of it as a standard
  /// deviation (a linear variable: to `share` of its unit scale). Positions must then be weighed by what they are
  /// really off.
  void suppose(BenchVariable variable, double share);
  /// By how many of its standard deviations this variable is away from where it was supposed; 0 where nothing was.
  [[nodiscard]] double surprise(BenchVariable variable) const;
  /// Fits of this variable start from where it was supposed.
  void start_from_supposed(BenchVariable variable);
  /// Fits of this variable start from `value` from now on, above 0; what is known or supposed of it stays.
  void start_from(BenchVariable variable, double value);
  /// Takes the linkage for a linear spring from now on, without knowing it.
  void assume_no_hysteresis() { params_.master.linkage.hysteretic_fraction = 0.0; }

  /// Finds `wanted` from the experiments, everything else as it is; where positions count, a constant force in each
  /// experiment is fitted along. Returns the root mean square of what is left of the weighted measurements. Errors: as
  /// `fit_nonlinear`.
  Result<double> fit(std::span<const BenchVariable> wanted, std::span<const BenchExperiment> experiments,
                     const MeasurementWeights& weights);

  /// What this knowledge leaves of the measured positions of an experiment, in m, a constant force fitted and the slow
  /// part left out where the experiment states it.
  [[nodiscard]] std::vector<double> left_m(const BenchExperiment& experiment) const;

  /// What is not known reaches from 0 to the largest number there is.
  [[nodiscard]] FoundParameter found(BenchVariable variable) const;
  /// Correlation matrix of these parameters, row by row, in the variables of a fit. What is no variable, as an area, or
  /// is not known goes with nothing.
  [[nodiscard]] std::vector<double> correlation(std::span<const FoundParameter> parameters) const;
  /// Energy that the linkage loses in a closed loop of its reference deflection, in J.
  [[nodiscard]] FoundParameter loop_area() const;

 private:
  BenchParams params_;
  struct Prior {
    double middle = 0.0;     ///< variable of a fit
    double deviation = 0.0;  ///< 0: none
  };
  std::array<bool, bench_variables> known_{};
  std::array<Prior, bench_variables> prior_{};
  std::vector<double> covariance_;  ///< of all variables, row by row; zero for what is not known
};

/// Position at every tick as the knowledge has it, without the constant force that a fit allows for.
std::vector<double> replay(const BenchKnowledge& knowledge, const BenchExperiment& experiment);

}  // namespace tactus::identification
