// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/clock.hpp>
#include <tactus/simulation/teleoperator/simulated_rig.hpp>

#include <cmath>
#include <numbers>
#include <utility>

namespace tactus::simulation {

namespace {

using identification::Assembly;

constexpr double unmoved_N = 1e6;
constexpr double vice_N_s_per_m = 1e9;
constexpr double wander_corner_Hz = 0.5;

/// The mechanism with what lies beyond the assembly taken off or locked, and what holds its handle.
struct PartialChain {
  mechanics::CableChain::Params mechanism;
  mechanics::LinearSpring::Params grip = mechanics::nobody_holds;
};

PartialChain partial_chain(const BenchedMaster& benched, Assembly assembly) {
  PartialChain chain{.mechanism = benched.master.mechanism};
  const auto take_off_linkage = [&chain] {
    chain.mechanism.linkage.stiffness_N_per_m = 0.0;
    chain.mechanism.linkage.damping_N_s_per_m = 0.0;
  };
  switch (assembly) {
    case Assembly::motor:
      chain.mechanism.cable = {.stiffness_N_per_m = 0.0, .damping_N_s_per_m = 0.0};
      take_off_linkage();
      break;
    case Assembly::cable:
      chain.mechanism.drum.friction_N = unmoved_N;
      take_off_linkage();
      break;
    case Assembly::drum:
      take_off_linkage();
      break;
    case Assembly::linkage:
      chain.grip.damping_N_s_per_m = vice_N_s_per_m;
      break;
    case Assembly::handle:
      break;
    case Assembly::held:
      chain.grip = benched.person.grip;
      break;
  }
  return chain;
}

/// Where the hand wants to be: white noise through two low-passes, so that it has a velocity.
class Wander {
 public:
  Wander(double rms_m, double tick_s, signal::Random random)
      : share_(-std::expm1(-2.0 * std::numbers::pi * wander_corner_Hz * tick_s)),
        drive_m_(std::numbers::sqrt2 * rms_m * std::sqrt(2.0 * share_)),
        random_(random) {}
  double step() noexcept {
    first_m_ += drive_m_ * random_.normal() - share_ * first_m_;
    return second_m_ += share_ * (first_m_ - second_m_);
  }

 private:
  double share_;
  double drive_m_;
  double first_m_ = 0.0;
  double second_m_ = 0.0;
  signal::Random random_;
};

Error stopped(double time_s, const char* what, double value, double lower, double upper, const Unit& unit) {
  return {ErrorCode::failed,
          {},
          "the run was stopped after " + rounded_number(time_s) + " s: the " + what + ", " + rounded_number(value) +
              " " + unit.symbol + ", left " + rounded_number(lower) + " to " + rounded_number(upper) + " " +
              unit.symbol + "; excite less, or with a stiffer or better damped virtual spring",
          {}};
}

}  // namespace

double loop_area_J(const mechanics::ElastoSlipSpring::Params& spring, double amplitude_m) {
  const auto made = mechanics::ElastoSlipSpring::make(spring, Seconds{1.0});
  if (!made) return std::nan("");
  double area_J = 0.0;
  const auto& elements = made->elements();
  for (std::size_t i = 0; i < elements.stiffness_N_per_m.size(); ++i) {
    area_J +=
        4.0 * elements.stiffness_N_per_m[i] * elements.slip_m[i] * std::max(0.0, amplitude_m - elements.slip_m[i]);
  }
  return area_J;
}

SimulatedRigParams draw_rig(std::int64_t seed) {
  signal::Random draw = signal::Random(static_cast<std::uint64_t>(seed)).fork(1);
  const auto off_by = [&draw](double& value, double share) { value *= draw.uniform(1.0 - share, 1.0 + share); };
  SimulatedRigParams rig;
  rig.seed = seed;
  auto& mechanism = rig.benched.master.mechanism;
  for (double* value :
       {&mechanism.motor.mass_kg, &mechanism.motor.friction_N, &mechanism.cable.stiffness_N_per_m,
        &mechanism.cable.damping_N_s_per_m, &mechanism.drum.mass_kg, &mechanism.drum.friction_N,
        &mechanism.linkage.stiffness_N_per_m, &mechanism.linkage.damping_N_s_per_m, &mechanism.tip.mass_kg}) {
    off_by(*value, 0.3);
  }
  mechanism.linkage.hysteretic_fraction = draw.uniform(0.2, 0.4);
  mechanism.linkage.slip_deflection_m = draw.uniform(70e-6, 140e-6);
  auto& person = rig.benched.person;
  off_by(person.grip.stiffness_N_per_m, 0.4);
  off_by(person.grip.damping_N_s_per_m, 0.4);
  off_by(person.correction.gain_per_s, 0.3);
  off_by(person.correction.reaction_time_s, 0.2);
  off_by(person.correction.bandwidth_Hz, 0.2);
  auto& amplifier = rig.benched.master.amplifier;
  amplifier.gain = draw.uniform(0.95, 1.05);
  amplifier.bandwidth_Hz = 1500.0 * std::pow(5000.0 / 1500.0, draw.uniform());
  rig.amplifier_offset_N = draw.uniform(-0.01, 0.01);
  rig.ripple_N = draw.uniform(0.0005, 0.001);
  rig.ripple_period_m = draw.uniform(0.003, 0.006);
  rig.ripple_phase_cycles = draw.uniform();
  off_by(rig.tremor_frequency_Hz, 0.2);
  off_by(rig.tremor_amplitude_m, 0.5);
  return rig;
}

Result<SimulatedRig> SimulatedRig::make(const SimulatedRigParams& params) {
  if (auto error = validate(params.benched)) return *std::move(error);
  const auto clock = Clock::make({}, {});
  if (!clock) return clock.error();
  if (auto chain = mechanics::CableChain::make(params.benched.master.mechanism, params.benched.person.grip,
                                               Seconds{clock->substep_s});
      !chain) {
    return under("master.mechanism", chain.error());
  }
  return SimulatedRig(params);
}

std::string SimulatedRig::name() const { return "simulated rig " + std::to_string(params_.seed); }

double SimulatedRig::tick_s() const { return 1.0 / ServoParams{}.rate_Hz; }

Check SimulatedRig::assemble(Assembly assembly) {
  assembly_ = assembly;
  return {};
}

Result<identification::RigRun> SimulatedRig::run(const identification::MotorProgram& program) {
  const identification::RigLimits& limits = params_.limits;
  if (auto error = identification::check(program, limits)) return *std::move(error);
  const auto clock = Clock::make({}, {});
  if (!clock) return clock.error();
  const Seconds tick{clock->tick_s};
  const Seconds substep{clock->substep_s};
  const PartialChain partial = partial_chain(params_.benched, assembly_);
  auto feedback = identification::MotorFeedback::make(program, tick);
  if (!feedback) return feedback.error();
  auto chain = mechanics::CableChain::make(partial.mechanism, partial.grip, substep);
  if (!chain) return chain.error();
  auto amplifier = mechanics::CurrentAmplifier::make(params_.benched.master.amplifier, substep);
  if (!amplifier) return amplifier.error();
  auto encoder = mechanics::Encoder::make({.resolution_m = params_.encoder_resolution_m}, tick);
  if (!encoder) return encoder.error();

  const auto stream = signal::Random(static_cast<std::uint64_t>(params_.seed))
                          .fork(identification::fingerprint(program) + static_cast<std::uint64_t>(assembly_));
  signal::Random current_noise = stream.fork(0);
  const bool held = assembly_ == Assembly::held;
  Wander wander(params_.wander_rms_m, tick.value, stream.fork(1));
  mechanics::Operator::Params hand;
  hand.grip = params_.benched.person.grip;
  hand.correction = params_.benched.person.correction;
  hand.tremor_amplitude_m = params_.tremor_amplitude_m;
  hand.tremor_frequency_Hz = params_.tremor_frequency_Hz;
  hand.tremor_phase_cycles = stream.fork(2).uniform();
  auto person = mechanics::Operator::make(hand, tick);
  if (!person) return under("operator", person.error());

  const std::size_t ticks = identification::length(program);
  identification::RigRun record;
  record.tick_s = tick.value;
  record.commanded_force_N.reserve(ticks);
  record.position_m.reserve(ticks);
  record.current_force_N.reserve(ticks);
  const double bias_N = params_.amplifier_offset_N / params_.benched.master.amplifier.gain;
  double held_command_N = 0.0;
  double path_m = 0.0;
  for (std::size_t i = 0; i < ticks; ++i) {
    const double time_s = static_cast<double>(i) * tick.value;
    const double true_position_m = chain->motor_position_m();
    const double position_m = encoder->step(true_position_m);
    const double reference_m = program.reference_m.empty() ? 0.0 : program.reference_m[i];
    const double command_N =
        (program.force_N.empty() ? 0.0 : program.force_N[i]) + feedback->step(reference_m - position_m);
    if (!between(limits.lower_position_m, limits.upper_position_m).contain(position_m)) {
      return stopped(time_s, "position", position_m, limits.lower_position_m, limits.upper_position_m, units::metre);
    }
    if (!between(-limits.force_N, limits.force_N).contain(command_N)) {
      return stopped(time_s, "commanded force", command_N, -limits.force_N, limits.force_N, units::newton);
    }
    record.position_m.push_back(position_m);
    record.commanded_force_N.push_back(command_N);
    record.current_force_N.push_back(amplifier->applied_force_N() +
                                     params_.current_noise_rms_N * current_noise.normal());

    mechanics::Operator::Output aim;
    if (held) {
      const double next_path_m = wander.step();
      aim = person->step(
          {.path_m = path_m, .path_at_next_tick_m = next_path_m, .handle_position_m = chain->tip_position_m()});
      path_m = next_path_m;
    }
    const double ripple_N =
        params_.ripple_N *
        std::sin(2.0 * std::numbers::pi * (true_position_m / params_.ripple_period_m + params_.ripple_phase_cycles));
    for (int s = 0; s < clock->substeps; ++s) {
      if (s == clock->late_substeps) held_command_N = command_N;
      const double middle_s = (s + 0.5) * substep.value;
      chain->step({.motor_force_N = amplifier->step(held_command_N + bias_N) + ripple_N,
                   .grip_position_m = aim.position_m + middle_s * aim.velocity_m_per_s,
                   .grip_velocity_m_per_s = aim.velocity_m_per_s});
    }
  }
  return record;
}

std::optional<double> SimulatedRig::truth(std::string_view name) const {
  const auto& [mechanism, amplifier] = params_.benched.master;
  const auto& [grip, correction] = params_.benched.person;
  const std::pair<std::string_view, double> known[] = {
      {"amplifier.gain", amplifier.gain},
      {"amplifier.offset_N", params_.amplifier_offset_N},
      {"amplifier.bandwidth_Hz", amplifier.bandwidth_Hz},
      {"amplifier.lag_s", ServoParams{}.computation_delay_s + 1.0 / (2.0 * std::numbers::pi * amplifier.bandwidth_Hz)},
      {"motor.mass_kg", mechanism.motor.mass_kg},
      {"motor.friction_N", mechanism.motor.friction_N},
      {"cable.stiffness_N_per_m", mechanism.cable.stiffness_N_per_m},
      {"cable.damping_N_s_per_m", mechanism.cable.damping_N_s_per_m},
      {"drum.mass_kg", mechanism.drum.mass_kg},
      {"drum.friction_N", mechanism.drum.friction_N},
      {"linkage.stiffness_N_per_m", mechanism.linkage.stiffness_N_per_m},
      {"linkage.damping_N_s_per_m", mechanism.linkage.damping_N_s_per_m},
      {"linkage.loop_area_J", loop_area_J(mechanism.linkage, mechanism.linkage.reference_deflection_m)},
      {"handle.mass_kg", mechanism.tip.mass_kg},
      {"operator.stiffness_N_per_m", grip.stiffness_N_per_m},
      {"operator.damping_N_s_per_m", grip.damping_N_s_per_m},
      {"operator.correction_gain_per_s", correction.gain_per_s},
      {"operator.reaction_time_s",
       correction.reaction_time_s + 1.0 / (2.0 * std::numbers::pi * correction.bandwidth_Hz)},
      {"operator.sight_bandwidth_Hz", correction.bandwidth_Hz},
  };
  for (const auto& [known_name, value] : known) {
    if (known_name == name) return value;
  }
  return std::nullopt;
}

}  // namespace tactus::simulation
