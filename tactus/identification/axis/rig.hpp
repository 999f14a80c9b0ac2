// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// A master device on the bench: what identification asks of it, whether it is simulated or is on a table.
///
/// All positions and forces are translated to the operator's hand, in m and N, positive toward the environment.
namespace tactus::identification {

/// How much of the master hangs on its motor, from the motor outward (paper A, Fig. 8). Inertial elements are looked at
/// with all that lies beyond taken off, connecting elements with the mass at their far end locked.
enum class Assembly {
  motor,    ///< the motor alone, everything beyond uncoupled
  cable,    ///< motor and cable, the drum locked
  drum,     ///< motor, cable and drum, the linkage taken off
  linkage,  ///< the same and the linkage, the handle locked
  handle,   ///< the whole master, held by nobody
  held,     ///< the whole master, held by the operator
};
constexpr auto enumerators(Assembly) {
  return std::array{Enumerator{Assembly::motor, "motor"},   Enumerator{Assembly::cable, "cable"},
                    Enumerator{Assembly::drum, "drum"},     Enumerator{Assembly::linkage, "linkage"},
                    Enumerator{Assembly::handle, "handle"}, Enumerator{Assembly::held, "held"}};
}

/// What an operator has to do to bring a master into this state, as one sentence.
std::string instruction(Assembly assembly);

/// What the motor may do. A program that would leave them is refused; a run that leaves them all the same is stopped.
struct RigLimits {
  double force_N = 5.0;
  double lower_position_m = -0.05;
  double upper_position_m = 0.05;
};

/// What the motor is commanded to do, one entry a tick: force = force_N + k (reference_m − x) + b · d/dt(reference_m −
/// x), the derivative by `signal::FilteredDerivative`. With a stiffness and no reference it is the virtual spring of
/// paper A, Sec. VII-B; with a reference, position control. `force_N` and `reference_m` have the same length, or one of
/// them is empty and counts as 0.
struct MotorProgram {
  std::vector<double> force_N;
  std::vector<double> reference_m;
  double stiffness_N_per_m = 0.0;
  double damping_N_s_per_m = 0.0;
  double derivative_cutoff_Hz = 100.0;
};

/// The ticks of a program.
inline std::size_t length(const MotorProgram& program) {
  return std::max(program.force_N.size(), program.reference_m.size());
}

/// A number that distinguishes programs: FNV-1a over the bits of all that they hold.
std::uint64_t fingerprint(const MotorProgram& program);

/// An error for a program that is empty, holds a number that is not finite, or leaves the limits by itself.
Check check(const MotorProgram& program, const RigLimits& limits);

/// The feedback law of a program, one tick after the other: for rigs, and for what imitates one.
class MotorFeedback {
 public:
  /// For a program that `check` passes. Errors: `inconsistent` for a derivative's cutoff beyond the tick.
  static Result<MotorFeedback> make(const MotorProgram& program, Seconds tick);
  /// Force in N for an error, reference less position, in m. Real-time safe.
  double step(double error_m) noexcept {
    return stiffness_N_per_m_ * error_m + damping_N_s_per_m_ * derivative_.step(error_m);
  }

 private:
  MotorFeedback(const MotorProgram& program, const signal::FilteredDerivative& derivative)
      : stiffness_N_per_m_(program.stiffness_N_per_m),
        damping_N_s_per_m_(program.damping_N_s_per_m),
        derivative_(derivative) {}
  double stiffness_N_per_m_;
  double damping_N_s_per_m_;
  signal::FilteredDerivative derivative_;
};

/// What came of it, one entry a tick.
struct RigRun {
  double tick_s = 0.0;
  std::vector<double> commanded_force_N;  ///< to the amplifier from this tick to the next, feedback included
  std::vector<double> position_m;         ///< of the motor, measured at this tick, before that force acts
  std::vector<double> current_force_N;    ///< of the motor's measured current at this tick; empty without a monitor
};

/// A bench with one master on it. Not real-time safe: a call returns when the run, or the operator, is done.
class Rig {
 public:
  virtual ~Rig() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual double tick_s() const = 0;
  [[nodiscard]] virtual RigLimits limits() const = 0;
  /// Has the master put into this state, where need be by an operator who is asked for one step. Errors: `failed` when
  /// it was not done.
  virtual Check assemble(Assembly assembly) = 0;
  /// Runs a program from rest near 0 and comes back to rest. Errors: `out_of_bounds` for a program that leaves the
  /// limits by itself, `failed` for a run that was stopped, with the time and the limit.
  virtual Result<RigRun> run(const MotorProgram& program) = 0;
};

}  // namespace tactus::identification
