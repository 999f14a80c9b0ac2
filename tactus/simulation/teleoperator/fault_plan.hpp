// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <array>
#include <cstdint>

/// Faults on purpose: what fails, when, for how long. The same described values serve the simulated channel and sensors
/// and whatever is between two real sites.
namespace tactus::simulation {

enum class FaultKind {
  none,
  loss_bursts,            ///< of packets, both ways
  disorder,               ///< delay, jitter that reorders, duplicates, both ways
  cut,                    ///< no packet either way
  restart,                ///< a site's process is killed and started again
  bad_number,             ///< one input is not a number, or a huge one, for one tick
  encoder_spike,          ///< one reading far off
  encoder_freeze,         ///< the reading stays
  encoder_wrap,           ///< the counter loses its highest bit
  force_dropout,          ///< the sensor at the tip reads nothing
  force_bias,             ///< it reads too much
  stall,                  ///< a site is not stepped; its motor holds the last force
  delayed_wall,           ///< delay both ways and a light grip, against the wall
  overload,               ///< a site misses ticks again and again
  stop_and_go,            ///< stalls, each shorter than what holds, one after another
  suspend,                ///< the machine sleeps, and its clock with it
  rate_drift,             ///< a site's clock runs fast or slow
  motor_reversed,         ///< a motor pushes the other way
  torque_constant,        ///< it gives more or less than commanded
  actuator_dead,          ///< it gives nothing
  actuator_stuck,         ///< it keeps a force whatever is commanded
  actuator_saturated,     ///< it gives no more than a part of its limit
  actuator_hot,           ///< its winding is cooled no more
  encoder_reversed,       ///< the encoder counts the other way
  encoder_slip,           ///< its shaft slips under load
  encoder_scale,          ///< it counts too much or too little
  encoder_drift,          ///< it creeps away
  encoder_noise,          ///< it scatters
  force_sensor_stuck,     ///< the force sensor keeps its reading
  force_sensor_gain,      ///< it reads too much or too little
  force_sensor_reversed,  ///< it reads the other way
  force_sensor_drift,     ///< it creeps away
  force_sensor_late,      ///< it reads what was
  channels_swapped,       ///< encoder and force sensor are at each other's input
  configurations_differ,  ///< the sites were given different parameters
  delay_asymmetric,       ///< one way takes longer than the other
  delay_creeping,         ///< the delay grows
  peer_repeats,           ///< the other site states the same again and again
  peer_wrong,             ///< it states what could be and is not
  both_restarted,         ///< both processes are killed at once
  dead_man_stuck,         ///< the dead-man switch stays pressed
  console_lost,           ///< the operator's console is gone
  hand_lets_go,           ///< nobody holds the handle
  handle_clamped,         ///< the handle is held fast
  two_faults,             ///< two faults at once
  fault_while_arming,     ///< a fault between arming and following
  stale_commands,         ///< a live controller continues with an old command
  emergency_stop,         ///< the operator presses the emergency stop
  power_lost,             ///< a motor's supply fails and comes back
  dead_man_released,      ///< the operator lets the dead-man switch go and holds on
  slow_stop,              ///< the emergency stop is pressed where forces may grow slowly only
  model_wrong,            ///< the model of an arm overstates its weight
};
constexpr auto enumerators(FaultKind) {
  return std::array{Enumerator{FaultKind::none, "none"},
                    Enumerator{FaultKind::loss_bursts, "loss-bursts"},
                    Enumerator{FaultKind::disorder, "disorder"},
                    Enumerator{FaultKind::cut, "cut"},
                    Enumerator{FaultKind::restart, "restart"},
                    Enumerator{FaultKind::bad_number, "bad-number"},
                    Enumerator{FaultKind::encoder_spike, "encoder-spike"},
                    Enumerator{FaultKind::encoder_freeze, "encoder-freeze"},
                    Enumerator{FaultKind::encoder_wrap, "encoder-wrap"},
                    Enumerator{FaultKind::force_dropout, "force-dropout"},
                    Enumerator{FaultKind::force_bias, "force-bias"},
                    Enumerator{FaultKind::stall, "stall"},
                    Enumerator{FaultKind::delayed_wall, "delayed-wall"},
                    Enumerator{FaultKind::overload, "overload"},
                    Enumerator{FaultKind::stop_and_go, "stop-and-go"},
                    Enumerator{FaultKind::suspend, "suspend"},
                    Enumerator{FaultKind::rate_drift, "rate-drift"},
                    Enumerator{FaultKind::motor_reversed, "motor-reversed"},
                    Enumerator{FaultKind::torque_constant, "torque-constant"},
                    Enumerator{FaultKind::actuator_dead, "actuator-dead"},
                    Enumerator{FaultKind::actuator_stuck, "actuator-stuck"},
                    Enumerator{FaultKind::actuator_saturated, "actuator-saturated"},
                    Enumerator{FaultKind::actuator_hot, "actuator-hot"},
                    Enumerator{FaultKind::encoder_reversed, "encoder-reversed"},
                    Enumerator{FaultKind::encoder_slip, "encoder-slip"},
                    Enumerator{FaultKind::encoder_scale, "encoder-scale"},
                    Enumerator{FaultKind::encoder_drift, "encoder-drift"},
                    Enumerator{FaultKind::encoder_noise, "encoder-noise"},
                    Enumerator{FaultKind::force_sensor_stuck, "force-sensor-stuck"},
                    Enumerator{FaultKind::force_sensor_gain, "force-sensor-gain"},
                    Enumerator{FaultKind::force_sensor_reversed, "force-sensor-reversed"},
                    Enumerator{FaultKind::force_sensor_drift, "force-sensor-drift"},
                    Enumerator{FaultKind::force_sensor_late, "force-sensor-late"},
                    Enumerator{FaultKind::channels_swapped, "channels-swapped"},
                    Enumerator{FaultKind::configurations_differ, "configurations-differ"},
                    Enumerator{FaultKind::delay_asymmetric, "delay-asymmetric"},
                    Enumerator{FaultKind::delay_creeping, "delay-creeping"},
                    Enumerator{FaultKind::peer_repeats, "peer-repeats"},
                    Enumerator{FaultKind::peer_wrong, "peer-wrong"},
                    Enumerator{FaultKind::both_restarted, "both-restarted"},
                    Enumerator{FaultKind::dead_man_stuck, "dead-man-stuck"},
                    Enumerator{FaultKind::console_lost, "console-lost"},
                    Enumerator{FaultKind::hand_lets_go, "hand-lets-go"},
                    Enumerator{FaultKind::handle_clamped, "handle-clamped"},
                    Enumerator{FaultKind::two_faults, "two-faults"},
                    Enumerator{FaultKind::fault_while_arming, "fault-while-arming"},
                    Enumerator{FaultKind::stale_commands, "stale-commands"},
                    Enumerator{FaultKind::emergency_stop, "emergency-stop"},
                    Enumerator{FaultKind::power_lost, "power-lost"},
                    Enumerator{FaultKind::dead_man_released, "dead-man-released"},
                    Enumerator{FaultKind::slow_stop, "slow-stop"},
                    Enumerator{FaultKind::model_wrong, "model-wrong"}};
}

enum class FaultSite { master, slave };
constexpr auto enumerators(FaultSite) {
  return std::array{Enumerator{FaultSite::master, "master"}, Enumerator{FaultSite::slave, "slave"}};
}

/// How a network treats packets. Losses come in bursts (E. N. Gilbert, Bell System Technical Journal 39, 1960; E. O.
/// Elliott, ibid. 42, 1963): a chain of two states, one that loses nothing and one that loses a share.
struct Impairment {
  double delay_s = 0.0;
  double jitter_s = 0.0;
  double duplicate_fraction = 0.0;
  double burst_begins_fraction = 0.0;
  double burst_ends_fraction = 1.0;
  double burst_loss_fraction = 1.0;
  static constexpr auto fields() {
    return List{
        field("delay_s", &Impairment::delay_s, units::second, between(0.0, 1.0), "Shortest delay of a packet."),
        field("jitter_s", &Impairment::jitter_s, units::second, between(0.0, 1.0),
              "Longest delay on top of it, drawn evenly for every packet, so that packets overtake one another."),
        field("duplicate_fraction", &Impairment::duplicate_fraction, units::none, between(0.0, 1.0),
              "Share of the packets that come twice."),
        field("burst_begins_fraction", &Impairment::burst_begins_fraction, units::none, between(0.0, 1.0),
              "Chance at each packet that a burst of losses begins."),
        field("burst_ends_fraction", &Impairment::burst_ends_fraction, units::none, between(0.0, 1.0),
              "Chance at each packet that a burst ends."),
        field("burst_loss_fraction", &Impairment::burst_loss_fraction, units::none, between(0.0, 1.0),
              "Share of the packets that are lost in a burst.")};
  }
};

/// What becomes of one packet: how many copies arrive, each after its delay.
struct PacketFate {
  int copies = 1;
  std::array<double, 2> delay_s{};
};

/// Draws the fate of each packet in turn. A value: no clock, socket or allocation. Real-time safe.
class ImpairedLink {
 public:
  ImpairedLink(const Impairment& impairment, signal::Random random) noexcept
      : impairment_(impairment), random_(random) {}

  PacketFate next() noexcept {
    const double turn = random_.uniform();
    bursting_ = bursting_ ? turn >= impairment_.burst_ends_fraction : turn < impairment_.burst_begins_fraction;
    PacketFate fate;
    if (bursting_ && random_.uniform() < impairment_.burst_loss_fraction) fate.copies = 0;
    if (fate.copies > 0 && random_.uniform() < impairment_.duplicate_fraction) fate.copies = 2;
    for (double& delay_s : fate.delay_s) delay_s = impairment_.delay_s + impairment_.jitter_s * random_.uniform();
    return fate;
  }

 private:
  Impairment impairment_;
  signal::Random random_;
  bool bursting_ = false;
};

/// One fault of one run.
struct FaultPlan {
  FaultKind kind = FaultKind::none;
  FaultSite site = FaultSite::master;
  double start_s = 0.8;
  double length_s = 0.0;
  double size = 0.0;
  std::int64_t choice = 0;
  std::int64_t seed = 1;
  Impairment impairment{};
  static constexpr auto fields() {
    return List{
        field("kind", &FaultPlan::kind, "What fails."),
        field("site", &FaultPlan::site, "Where, if at one site."),
        field("start_s", &FaultPlan::start_s, units::second, non_negative, "When it begins."),
        field("length_s", &FaultPlan::length_s, units::second, non_negative, "How long it lasts."),
        field("size", &FaultPlan::size, units::none, any_finite,
              "How far an encoder spikes or wraps in m, how much a force sensor is off in N; of another fault what its "
              "row states."),
        field("choice", &FaultPlan::choice, non_negative,
              "The plan's number: which input, value and state a bad number takes."),
        field("seed", &FaultPlan::seed, non_negative, "Of the packets' fates and the operator's path."),
        field("impairment", &FaultPlan::impairment, "How the network treats packets while the fault lasts.")};
  }
};

}  // namespace tactus::simulation
