#include <tactus/mechanics/electric_slave.hpp>

#include <algorithm>

namespace tactus::mechanics {

namespace {

/// The wall's force is held over a substep, so its damping b limits the step like a further stiffness of 2 b / h.
Check check_wall(const CableChain::Params& mechanism, const Environment::Params& wall, Seconds dt) {
  const bool viscous = wall.law == ContactLaw::kelvin_voigt;
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

double ElectricSlave::contact_force(const CableChain& mechanism, double duration_s) noexcept {
  const double velocity = mechanism.tip_velocity_m_per_s();
  return environment_.step(
      {.position_m = mechanism.tip_position_m() + 0.5 * duration_s * velocity, .velocity_m_per_s = velocity});
}

double ElectricSlave::crossing_time(double motor_force_N, double gap_now_m, double gap_after_m) noexcept {
  // Illinois variant of false position, a fixed number of rounds: the worst case is the usual case. The tip's path
  // within a substep is close to a straight line, so four rounds leave far less than a nanosecond.
  double early = 0.0, late = dt_s_;
  double gap_early = gap_now_m, gap_late = gap_after_m;
  double time = 0.0;
  for (int round = 0; round < 4; ++round) {
    time = std::clamp(late - gap_late * (late - early) / (gap_late - gap_early), 0.0, dt_s_);
    CableChain trial = mechanism_;
    trial.advance({.motor_force_N = motor_force_N, .tip_force_N = -contact_force(trial, time)}, time);
    const double gap = environment_.position_m() - trial.tip_position_m();
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

ElectricSlave::Output ElectricSlave::step(double commanded_force_N) noexcept {
  const double motor_force = amplifier_.step(commanded_force_N);
  const double gap_now = environment_.position_m() - mechanism_.tip_position_m();
  double force = contact_force(mechanism_, dt_s_);
  CableChain after = mechanism_;
  after.step({.motor_force_N = motor_force, .tip_force_N = -force});
  const double gap_after = environment_.position_m() - after.tip_position_m();

  Output output;
  const bool crosses = (gap_now > 0.0) != (gap_after > 0.0);
  if (crosses) {
    const double until = crossing_time(motor_force, gap_now, gap_after);
    const double before_force = contact_force(mechanism_, until);
    mechanism_.advance({.motor_force_N = motor_force, .tip_force_N = -before_force}, until);
    const double rest = dt_s_ - until;
    const double after_force = contact_force(mechanism_, rest);
    mechanism_.advance({.motor_force_N = motor_force, .tip_force_N = -after_force}, rest);
    force = (before_force * until + after_force * rest) / dt_s_;
    output.touched = gap_now > 0.0;
    output.touched_after_s = until;
  } else {
    mechanism_ = after;
  }
  output.contact_force_N = force;
  force_sensor_.step(force);
  return output;
}

void ElectricSlave::reset(double position_m) noexcept {
  mechanism_.reset(position_m);
  amplifier_.reset();
  encoder_.reset();
  force_sensor_.reset();
}

}  // namespace tactus::mechanics
