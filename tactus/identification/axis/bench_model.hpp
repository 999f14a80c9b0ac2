// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/rig.hpp>
#include <tactus/kernel/control/model/induced_motion_model.hpp>

#include <vector>

/// What a run on the bench would have shown, were the master as a model states.
namespace tactus::identification {

/// Everything that shapes a run: amplifier, the controller's model of master and hand, and the operator's slow
/// correction. Forces and positions are translated to the hand.
struct BenchParams {
  double amplifier_gain = 1.0;
  double amplifier_offset_N = 0.0;  ///< applied without a command
  double amplifier_bandwidth_Hz = 3000.0;
  /// By how much the force comes after the sample that it follows from, on average: the computation's delay and the
  /// amplifier's lag, 1/(2π bandwidth), together. The delay is what is left of it, from none to a tick; a bandwidth too
  /// low for it counts as 1/(2π lag).
  double amplifier_lag_s = 1e-4;
  control::MasterModel master = bare();
  /// The operator shifts the aim of the grip at −gain times what is seen of the handle's position, which is low-passed
  /// at the sight's bandwidth and late by what is left of the reaction time, 1/(2π bandwidth) less; a bandwidth too low
  /// for it counts as 1/(2π reaction time).
  double correction_gain_per_s = 4.0;
  double reaction_time_s = 0.13;
  double sight_bandwidth_Hz = 5.0;  ///< paper A, Sec. VI
  double bias_N = 0.0;  ///< constant force on the motor that is nobody's: cogging where the run happens to be

  /// Table I without the quintic spring, which belongs to cancellation and to no hand.
  static control::MasterModel bare() {
    control::MasterModel master;
    master.hand.quintic_stiffness_N_per_m5 = 0.0;
    return master;
  }
};

/// The measured current at every tick, in N, of what the amplifier would make of these commands. For parameters greater
/// than 0.
std::vector<double> simulate_current(const BenchParams& params, const RigRun& run);

/// The motor's position at every tick of a run, in m, not quantised.
///
/// The commands are those of the run. Where the program has feedback, the command is corrected by what the feedback
/// would have made of the difference between measured and simulated position, so that the simulated motor is held by
/// its virtual spring as the real one was, and small errors of the model do not make it drift off.
///
/// The integrator is the controller's (`control::InducedMotionModel`, exact step), `steps_per_tick` steps a tick each
/// with the mean and the centre of the applied force; it shares nothing with the simulated devices. What is beyond the
/// assembly is left out, what is locked weighs 1e9 kg. Not a number where the parameters make no model.
std::vector<double> simulate_position(const BenchParams& params, Assembly assembly, const MotorProgram& program,
                                      const RigRun& run, int steps_per_tick);

/// The run at every `ticks`-th tick: commands averaged, positions picked. For slow motion, and no feedback.
RigRun thinned(const RigRun& run, std::size_t ticks);

}  // namespace tactus::identification
