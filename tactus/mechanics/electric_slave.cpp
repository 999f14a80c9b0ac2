#include <tactus/mechanics/electric_slave.hpp>

#include <algorithm>

namespace tactus::mechanics {

namespace {

/// The wall's force is held over a substep, so its damping b limits the step like a further stiffness of 2 b / h.
Check check_wall(const CableChain::Params& mechanism, const Environment::Params& wall, Seconds dt) {
  const bool viscous = wall.law != ContactLaw::hunt_crossley;
  const double from_damping = viscous ? 2.0 * wall.damping_N_s_per_m / dt.value : 0.0;
  const char* const stiffer =
      from_damping > wall.stiffness_N_per_m ? "environment.damping_N_s_per_m" : "environment.stiffness_N_per_m";
  auto error = CableChain::check_step(mechanism, wall.stiffness_N_per_m + from_damping, stiffer, dt);
  if (error && error->parameter != stiffer) return under("mechanism", *std::move(error));
  return error;
}

}  // namespace

Result<ElectricSlave> ElectricSlave::make(const Params& params, const Environment::Params& environment, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto mechanism = CableChain::make(params.mechanism, dt);
  if (!mechanism) return under("mechanism", mechanism.error());
  const auto amplifier = CurrentAmplifier::make(params.amplifier, dt);
  if (!amplifier) return under("amplifier", amplifier.error());
  const auto encoder = Encoder::make(params.encoder, dt);
  if (!encoder) return under("encoder", encoder.error());
  const auto force_sensor = ForceSensor::make(params.force_sensor, dt);
  if (!force_sensor) return under("force_sensor", force_sensor.error());
  const auto wall = Environment::make(environment, dt);
  if (!wall) return under("environment", wall.error());
  if (auto error = check_wall(params.mechanism, environment, dt)) return *std::move(error);
  return ElectricSlave(*mechanism, *amplifier, *encoder, *force_sensor, *wall, dt);
}

double ElectricSlave::advance(double motor_force_N, double duration_s) noexcept {
  const double force_N = contact_force(duration_s);
  mechanism_.advance({.motor_force_N = motor_force_N, .tip_force_N = -force_N}, duration_s);
  return force_N;
}

double ElectricSlave::crossing_time(const CableChain::State& before, double motor_force_N) noexcept {
  // Illinois variant of false position, a fixed number of rounds: the worst case is the usual case. The tip's path
  // within a substep is close to a straight line, so four rounds leave far less than a nanosecond.
  double early = 0.0, late = dt_s_;
  double gap_early = environment_.position_m() - before.position_m[2];
  double gap_late = environment_.position_m() - mechanism_.tip_position_m();
  double time = 0.0;
  for (int round = 0; round < 4; ++round) {
    time = std::clamp(late - gap_late * (late - early) / (gap_late - gap_early), 0.0, dt_s_);
    mechanism_.set_state(before);
    advance(motor_force_N, time);
    const double gap = environment_.position_m() - mechanism_.tip_position_m();
    if ((gap > 0.0) == (gap_late > 0.0)) {
      late = time;
      gap_late = gap;
      gap_early *= 0.5;
    } else {
      early = time;
      gap_early = gap;
      gap_late *= 0.5;
    }
  }
  return time;
}

ElectricSlave::Output ElectricSlave::step_across_surface(const CableChain::State& before,
                                                         double motor_force_N) noexcept {
  const double until = crossing_time(before, motor_force_N);
  mechanism_.set_state(before);
  const double before_force_N = advance(motor_force_N, until);
  const double rest = dt_s_ - until;
  const double after_force_N = advance(motor_force_N, rest);
  return {.contact_force_N = (before_force_N * until + after_force_N * rest) / dt_s_,
          .touched = is_outside(before.position_m[2]),
          .touched_after_s = until};
}

void ElectricSlave::reset(double position_m) noexcept {
  mechanism_.reset(position_m);
  amplifier_.reset();
  encoder_.reset();
  force_sensor_.reset();
}

}  // namespace tactus::mechanics
