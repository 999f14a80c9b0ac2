// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/rig.hpp>

#include <bit>
#include <cmath>

namespace tactus::identification {

namespace {

Check check_range(const std::vector<double>& values, const char* name, double lower, double upper, const Unit& unit) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (between(lower, upper).contain(values[i])) continue;
    return out_of_bounds(std::string(name) + "[" + std::to_string(i) + "]", values[i], between(lower, upper), unit);
  }
  return {};
}

}  // namespace

Check check(const MotorProgram& program, const RigLimits& limits) {
  const std::size_t forces = program.force_N.size();
  const std::size_t references = program.reference_m.size();
  if (forces + references == 0) {
    return Error{ErrorCode::missing, "force_N", "the program is empty: give it forces, references or both", {}};
  }
  if (forces != references && forces != 0 && references != 0) {
    return Error{ErrorCode::inconsistent,
                 "reference_m",
                 "there are " + std::to_string(forces) + " forces and " + std::to_string(references) +
                     " references: give as many of both, or none of one",
                 {}};
  }
  if (!non_negative.contain(program.stiffness_N_per_m)) {
    return out_of_bounds("stiffness_N_per_m", program.stiffness_N_per_m, non_negative, units::newton_per_metre);
  }
  if (!non_negative.contain(program.damping_N_s_per_m)) {
    return out_of_bounds("damping_N_s_per_m", program.damping_N_s_per_m, non_negative, units::newton_second_per_metre);
  }
  if (auto error = check_range(program.force_N, "force_N", -limits.force_N, limits.force_N, units::newton)) {
    return error;
  }
  return check_range(program.reference_m, "reference_m", limits.lower_position_m, limits.upper_position_m,
                     units::metre);
}

std::uint64_t fingerprint(const MotorProgram& program) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&hash](double value) { hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3; };
  for (const double force_N : program.force_N) add(force_N);
  for (const double reference_m : program.reference_m) add(reference_m);
  add(program.stiffness_N_per_m);
  add(program.damping_N_s_per_m);
  add(program.derivative_cutoff_Hz);
  return hash;
}

std::string instruction(Assembly assembly) {
  switch (assembly) {
    case Assembly::motor:
      return "Take the cable off the motor, so that it turns alone.";
    case Assembly::cable:
      return "Put the cable on and lock the drum.";
    case Assembly::drum:
      return "Unlock the drum and take the linkage off it.";
    case Assembly::linkage:
      return "Put the linkage on and lock the handle.";
    case Assembly::handle:
      return "Unlock the handle and release it.";
    case Assembly::held:
      break;
  }
  return "Hold the handle in a comfortable grip and keep it where it is.";
}

Result<MotorFeedback> MotorFeedback::make(const MotorProgram& program, Seconds tick) {
  const auto derivative = signal::FilteredDerivative::make({.cutoff_Hz = program.derivative_cutoff_Hz}, tick);
  if (!derivative) {
    Error error = derivative.error();
    if (error.parameter == "cutoff_Hz") error.parameter = "derivative_cutoff_Hz";
    return error;
  }
  return MotorFeedback(program, *derivative);
}

}  // namespace tactus::identification
