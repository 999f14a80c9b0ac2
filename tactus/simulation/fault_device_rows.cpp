#include <tactus/simulation/internal/fault_families.hpp>

#include <cmath>

namespace tactus::simulation::fault_families {

namespace {

/// One of two ranges, each drawn evenly in its logarithm: well below what is right or well above.
double below_or_above(signal::Random& random, double lowest, double below, double above, double highest) {
  return random.uniform() < 0.5 ? between_logarithms(random, lowest, below)
                                : between_logarithms(random, above, highest);
}

/// What is wired wrongly is so from the start.
void from_the_start(FaultPlan& plan) {
  plan.start_s = 0.0;
  plan.length_s = 1.5;
}

/// A force that is wrong by twice what the balance of forces lets pass must not stay unseen.
std::string_view wrong_force(const FaultPlan&, const FaultOutcome& outcome, const FaultsParams& params) {
  const double limit_N = params.control.supervision.force_sensor.residual_limit_N;
  return outcome.detection_ticks >= 0 || outcome.fault_N < 2.0 * limit_N ? std::string_view{} : unseen;
}
std::string_view seen(const FaultPlan&, const FaultOutcome& outcome, const FaultsParams&) {
  return outcome.detection_ticks >= 0 ? std::string_view{} : unseen;
}
std::string_view cool(const FaultPlan&, const FaultOutcome& outcome, const FaultsParams&) {
  return outcome.winding_warmth <= 1.0 ? "" : "a winding was damaged";
}

}  // namespace

std::vector<FaultRow> device_rows() {
  return {
      {FaultKind::motor_reversed, "motor-reversed", "motor reversed", "from the start or while following",
       "refused on arming, or hold"},
      {FaultKind::torque_constant, "torque-constant", "torque constant wrong", "0.2 to 0.5 or 2 to 5 times the force",
       "hold where it matters", wrong_force},
      {FaultKind::actuator_dead, "actuator-dead", "actuator dead", "gives nothing for 1 s", "hold where it matters",
       wrong_force},
      {FaultKind::actuator_stuck, "actuator-stuck", "actuator stuck",
       "1 to 5 N either way, whatever it is told, for 1 s", "hold, drive off", wrong_force},
      {FaultKind::actuator_saturated, "actuator-saturated", "actuator saturated", "gives 0.1 to 1 N at most for 1.5 s",
       "hold where it matters", wrong_force},
      {FaultKind::actuator_hot, "actuator-hot", "actuator hot", "cooling lost while the person presses for 10 s",
       "less force before a winding is damaged", cool},
      {FaultKind::encoder_reversed, "encoder-reversed", "encoder reversed", "from the start", "refused on arming"},
      {FaultKind::encoder_slip, "encoder-slip", "encoder slips", "loses 20 to 60 % of the way forward, for 2 s",
       "bounded"},
      {FaultKind::encoder_scale, "encoder-scale", "encoder scale wrong",
       "0.1 to 0.25 or 4 to 10 times the way, from the start", "refused on arming"},
      {FaultKind::encoder_drift, "encoder-drift", "encoder drifts", "0.1 to 0.3 m/s into the wall for 1 s",
       "bounded by the force limit"},
      {FaultKind::encoder_noise, "encoder-noise", "encoder noisy", "0.3 to 3 mm RMS for 1 s", "latched", seen},
      {FaultKind::force_sensor_stuck, "force-sensor-stuck", "force sensor stuck", "keeps its reading for 1.5 s",
       "hold where it matters", wrong_force},
      {FaultKind::force_sensor_gain, "force-sensor-gain", "force sensor gain wrong",
       "0.1 to 0.3 or 3 to 10 times the force for 1.5 s", "hold where it matters", wrong_force},
      {FaultKind::force_sensor_reversed, "force-sensor-reversed", "force sensor reversed", "for 1.5 s",
       "hold where it matters", wrong_force},
      {FaultKind::force_sensor_drift, "force-sensor-drift", "force sensor drifts", "by 1 to 10 N/s for 1.5 s", "hold",
       wrong_force},
      {FaultKind::force_sensor_late, "force-sensor-late", "force sensor late", "by 30 to 150 ms for 1.5 s",
       "hold where it matters", wrong_force},
      {FaultKind::channels_swapped, "channels-swapped", "channels swapped", "encoder and force sensor, from the start",
       "refused on arming, or latched", seen},
      {FaultKind::hand_lets_go, "hand-lets-go", "hand lets go", "for 1 s, dead-man in the handle or on the floor",
       "slow, no energy"},
      {FaultKind::handle_clamped, "handle-clamped", "handle clamped", "held fast and pushed 20 to 60 mm on, for 1 s",
       "bounded force"},
      {FaultKind::power_lost, "power-lost", "power lost", "of a motor for 50 to 500 ms",
       "hold; no step when it comes back", wrong_force},
  };
}

void draw_device(FaultPlan& plan, signal::Random& random, double sign) {
  switch (plan.kind) {
    case FaultKind::motor_reversed:
      plan.length_s = 1.0;
      if (plan.choice % 2 == 0) from_the_start(plan);
      break;
    case FaultKind::encoder_reversed:
    case FaultKind::channels_swapped:
      from_the_start(plan);
      break;
    case FaultKind::encoder_scale:
      from_the_start(plan);
      plan.size = below_or_above(random, 0.1, 0.25, 4.0, 10.0);
      break;
    case FaultKind::torque_constant:
      plan.length_s = 1.5;
      plan.size = below_or_above(random, 0.2, 0.5, 2.0, 5.0);
      break;
    case FaultKind::actuator_dead:
      plan.length_s = 1.0;
      break;
    case FaultKind::actuator_stuck:
      plan.length_s = 1.0;
      plan.size = sign * random.uniform(1.0, 5.0);
      break;
    case FaultKind::actuator_saturated:
      plan.length_s = 1.5;
      plan.size = between_logarithms(random, 0.1, 1.0);
      break;
    case FaultKind::actuator_hot:
      plan.length_s = 10.0;
      plan.size = random.uniform(1.2, 1.6);
      break;
    case FaultKind::encoder_slip:
      plan.length_s = 2.0;
      plan.size = random.uniform(0.2, 0.6);
      break;
    case FaultKind::encoder_drift:
      plan.length_s = 1.0;
      plan.size = (plan.site == FaultSite::master ? 1.0 : -1.0) * random.uniform(0.1, 0.3);
      break;
    case FaultKind::encoder_noise:
      plan.length_s = 1.0;
      plan.size = between_logarithms(random, 0.0003, 0.003);
      break;
    case FaultKind::force_sensor_stuck:
    case FaultKind::force_sensor_reversed:
      plan.length_s = 1.5;
      break;
    case FaultKind::force_sensor_gain:
      plan.length_s = 1.5;
      plan.size = below_or_above(random, 0.1, 0.3, 3.0, 10.0);
      break;
    case FaultKind::force_sensor_drift:
      plan.length_s = 1.5;
      plan.size = sign * between_logarithms(random, 1.0, 10.0);
      break;
    case FaultKind::force_sensor_late:
      plan.length_s = 1.5;
      plan.size = random.uniform(0.03, 0.15);
      break;
    case FaultKind::hand_lets_go:
      plan.length_s = 1.0;
      break;
    case FaultKind::handle_clamped:
      plan.length_s = 1.0;
      plan.size = random.uniform(0.02, 0.06);
      break;
    case FaultKind::power_lost:
      plan.length_s = between_logarithms(random, 0.05, 0.5);
      break;
    default:
      break;
  }
}

}  // namespace tactus::simulation::fault_families
