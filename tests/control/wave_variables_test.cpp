// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/wave_variables.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/control/random_line.hpp"
#include <gtest/gtest.h>

namespace tactus::control {
namespace wave_variables_test {

static_assert(Element<WaveMaster>);
static_assert(Element<WaveSlave>);

constexpr double tick_s = 200e-6;

WaveMaster master_of(const WaveMaster::Params& params) { return WaveMaster::make(params, Seconds{tick_s}).value(); }
WaveSlave slave_of(const WaveSlave::Params& params) { return WaveSlave::make(params, Seconds{tick_s}).value(); }

/// The energy that is stored between the two ports, from nothing but what the sites show: force and motion of the
/// hand's end; force and returned wave of the slave's end, which tell its velocity.
struct PortEnergy {
  double scale;      ///< lambda
  double gain;       ///< mu
  double impedance;  ///< b
  signal::FilteredDerivative velocity;
  double stored_J = 0.0;
  double turnover_J = 0.0;

  void count(double position_m, const MasterOutput& master, const SlaveOutput& slave) {
    const double in_J = -master.motor_force_N / gain * scale * velocity.step(position_m) * tick_s;
    const double arrived = slave.message.wave + std::sqrt(2.0 / impedance) * slave.motor_force_N;
    const double wanted_m_per_s = (arrived + slave.message.wave) / std::sqrt(2.0 * impedance);
    const double out_J = slave.motor_force_N * wanted_m_per_s * tick_s;
    stored_J += in_J - out_J;
    turnover_J += std::fabs(in_J) + std::fabs(out_J);
  }
};

TEST(WaveVariables, NoLineMakesEnergyWhateverIsDoneAtItsEnds) {
  int tight = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    Draw draw(seed);
    WaveMaster::Params params;
    params.position_scale = draw.between(0.2, 3.0);
    params.force_gain = draw.between(0.1, 15.0);
    params.force_limit_N = draw.between(0.2, 10.0);
    params.wave.impedance_N_s_per_m = draw.between(0.3, 30.0);
    params.wave.cutoff_Hz = draw.between(20.0, 2400.0);
    params.wave.correction_time_s = draw.between(0.002, 0.2);
    WaveSlave::Params slave_params{.slave = {}, .wave = params.wave};
    slave_params.slave.proportional_N_per_m = draw.between(0.0, 1000.0);
    slave_params.slave.derivative_N_s_per_m = draw.between(0.0, 10.0);
    WaveMaster master = master_of(params);
    WaveSlave slave = slave_of(slave_params);
    RandomLine to_slave = RandomLine::any(draw);
    RandomLine to_master = RandomLine::any(draw);
    RandomMotion hand(draw, draw.between(1e-6, 1e-4), seed % 3 != 0);
    RandomMotion tool(draw, draw.between(1e-6, 1e-4), seed % 2 != 0);
    PortEnergy energy{params.position_scale, params.force_gain, params.wave.impedance_N_s_per_m,
                      signal::FilteredDerivative::make(params.wave.velocity, Seconds{tick_s}).value()};
    Arrival back;
    double least_J = 0.0;
    for (int tick = 0; tick < 5000; ++tick) {
      const double hand_m = hand.step();
      const auto out = master.step({.motor_position_m = hand_m, .arrival = back});
      const auto answer = slave.step({.motor_position_m = tool.step(), .arrival = to_slave.step(out.message)});
      back = to_master.step(answer.message);
      energy.count(hand_m, out, answer);
      ASSERT_GE(energy.stored_J, -1e-12 * energy.turnover_J) << "seed " << seed << ", tick " << tick;
      least_J = std::max(least_J, energy.stored_J);
    }
    if (energy.stored_J < 0.5 * least_J) ++tight;
  }
  EXPECT_GE(tight, 5) << "the lines never gave back much of what they held, so the bound was not tried";
}

TEST(WaveVariables, TheWorkThatTheLineCountsIsWhatTheHeldForceDidAtTheHand) {
  WaveMaster::Params params;
  params.force_limit_N = 100.0;
  params.wave.cutoff_Hz = params.wave.velocity.cutoff_Hz = 2000.0;
  WaveMaster master = master_of(params);
  // A slave without a spring: what flows is used up, so the balance is no small difference of large numbers.
  WaveSlave slave = slave_of({.slave = {.proportional_N_per_m = 0.0}, .wave = params.wave});
  Arrival back;
  double done_J = 0.0, held_N = 0.0, before_m = 0.0, in_J = 0.0, returned_J = 0.0;
  for (int tick = 0; tick < 5000; ++tick) {
    const double position_m = 0.01 * std::sin(10.0 * std::numbers::pi * tick * tick_s);
    done_J -= held_N * (position_m - before_m);
    before_m = position_m;
    // A low-pass at 2 kHz takes away nothing of 5 Hz.
    returned_J += 0.5 * tick_s * back.message.wave * back.message.wave;
    const auto out = master.step({.motor_position_m = position_m, .arrival = back});
    in_J += 0.5 * tick_s * out.message.wave * out.message.wave;
    held_N = out.motor_force_N;
    const auto answer = slave.step({.motor_position_m = 0.0, .arrival = {.message = out.message, .fresh = true}});
    back = {.message = answer.message, .fresh = true};
  }
  EXPECT_GT(done_J, 1e-3);
  EXPECT_NEAR((in_J - returned_J) / done_J, 1.0, 0.02);
}

TEST(WaveVariables, WithoutDelayTheSitesAreCoupledByTheSlavesSpringAndDamper) {
  WaveMaster::Params params;
  params.force_limit_N = 100.0;
  params.position_scale = 2.0;
  params.force_gain = 3.0;
  params.wave.cutoff_Hz = 2000.0;
  params.wave.velocity.cutoff_Hz = 2000.0;
  WaveSlave::Params slave_params{.slave = {.proportional_N_per_m = 80.0, .derivative_N_s_per_m = 0.5},
                                 .wave = params.wave};
  WaveMaster master = master_of(params);
  WaveSlave slave = slave_of(slave_params);
  Arrival back;
  constexpr double omega = 2.0 * std::numbers::pi * 2.0;
  for (int tick = 0; tick < 10000; ++tick) {
    const double t = tick * tick_s;
    const auto out = master.step({.motor_position_m = 0.004 * std::sin(omega * t), .arrival = back});
    const auto answer = slave.step({.motor_position_m = 0.0, .arrival = {.message = out.message, .fresh = true}});
    back = {.message = answer.message, .fresh = true};
    if (tick < 1000) continue;
    const double coupling_N = 2.0 * 0.004 * (80.0 * std::sin(omega * t) + 0.5 * omega * std::cos(omega * t));
    // The loop's own delay of a tick and the two filters show as a damper of b·dt or so.
    ASSERT_NEAR(answer.motor_force_N, coupling_N, 0.02 * 0.65) << t;
    ASSERT_NEAR(-out.motor_force_N, 3.0 * coupling_N, 0.02 * 3.0 * 0.65) << t;
  }
}

TEST(WaveVariables, ASlaveWhoseDamperIsTheWaveImpedanceReflectsNothing) {
  for (const double damping : {1.0, 5.0, 20.0}) {
    WaveSlave::Params params;
    params.slave = {.proportional_N_per_m = 0.0, .derivative_N_s_per_m = damping};
    params.wave.impedance_N_s_per_m = 5.0;
    WaveSlave slave = slave_of(params);
    Message message;
    double last_in = 0.0, last_out = 0.0;
    for (int tick = 0; tick < 200; ++tick) {
      message.wave = 0.1;
      message.position_m += std::sqrt(2.0 / 5.0) * tick_s * message.wave;
      message.energy_J += 0.5 * tick_s * message.wave * message.wave;
      const auto out = slave.step({.motor_position_m = 0.0, .arrival = {.message = message, .fresh = true}});
      last_in = message.wave;
      last_out = out.message.wave;
    }
    // A line of impedance b that ends in a damper d.
    EXPECT_NEAR(last_out / last_in, (5.0 - damping) / (5.0 + damping), 1e-9);
  }
}

/// Amplitude of what the receiver makes of a wave of the given frequency that arrives in full.
double gain_of(const WaveParams& params, double frequency_Hz) {
  WaveReceiver receiver = WaveReceiver::make(params, Seconds{tick_s}).value();
  Message message;
  double largest = 0.0;
  for (int tick = 0; tick < 20000; ++tick) {
    message.wave = std::sin(2.0 * std::numbers::pi * frequency_Hz * tick * tick_s);
    message.position_m += std::sqrt(2.0 / params.impedance_N_s_per_m) * tick_s * message.wave;
    message.energy_J += 0.5 * tick_s * message.wave * message.wave;
    const double out = receiver.step({.message = message, .fresh = true}, 0.0);
    if (tick >= 10000) largest = std::max(largest, std::fabs(out));
  }
  return largest;
}

TEST(WaveReceiver, TheLowPassHasItsCutoffWhereItSays) {
  WaveParams params;
  // Frequencies whose samples pass within 1e-3 of the crest.
  for (const double cutoff_Hz : {37.0, 301.0, 1237.0}) {
    params.cutoff_Hz = cutoff_Hz;
    EXPECT_NEAR(gain_of(params, cutoff_Hz), std::sqrt(0.5), 1e-3);
    EXPECT_NEAR(gain_of(params, cutoff_Hz / 50.0), 1.0, 1e-3);
  }
}

TEST(WaveReceiver, ATickWithoutAMessageTakesAZeroWave) {
  WaveParams params;
  params.cutoff_Hz = 2499.0;  // the least that the filter can remember: a pole of 0.17
  WaveReceiver receiver = WaveReceiver::make(params, Seconds{tick_s}).value();
  const double wave = 0.2;
  const Message message{.position_m = std::sqrt(2.0 / params.impedance_N_s_per_m) * tick_s * wave,
                        .wave = wave,
                        .energy_J = 0.5 * tick_s * wave * wave};
  double sum = receiver.step({.message = message, .fresh = true}, 0.0);
  EXPECT_GT(sum, 0.8 * wave);
  for (int tick = 0; tick < 100; ++tick) sum += receiver.step({.message = message, .fresh = false}, 0.0);
  EXPECT_NEAR(sum, wave, 1e-12);
}

/// Where the slave, a mass of 30 g, is behind the master after seconds of motion on a line that loses.
double drift_of(double correction_time_s) {
  WaveMaster::Params params;
  params.wave.correction_time_s = correction_time_s;
  WaveMaster master = master_of(params);
  WaveSlave slave = slave_of({.slave = {}, .wave = params.wave});
  Draw draw(7);
  RandomLine to_slave(draw, 25, 10, 0.3), to_master(draw, 25, 10, 0.3);
  Arrival back;
  double tool_m = 0.0, tool_m_per_s = 0.0, hand_m = 0.0;
  for (int tick = 0; tick < 25000; ++tick) {
    // There and back by 50 mm, faster one way than the other, and then at rest.
    const double t = tick * tick_s;
    if (t < 4.0) hand_m += tick_s * 0.05 * (std::sin(2.0 * t) + std::sin(4.0 * t));
    const auto out = master.step({.motor_position_m = hand_m, .arrival = back});
    const auto answer = slave.step({.motor_position_m = tool_m, .arrival = to_slave.step(out.message)});
    back = to_master.step(answer.message);
    tool_m_per_s += tick_s * answer.motor_force_N / 0.03;
    tool_m += tick_s * tool_m_per_s;
  }
  return std::fabs(tool_m - hand_m);
}

TEST(WaveVariables, PositionThatLostMessagesCarriedIsMadeUpFor) {
  EXPECT_LT(drift_of(0.05), 1e-6);
  // Without the correction, or as good as, this line does lose position.
  EXPECT_GT(drift_of(10.0), 5e-3);
}

TEST(WaveVariables, AMessageThatIsNotANumberReachesTheGate) {
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
  for (const Message& message :
       {Message{.position_m = not_a_number}, Message{.wave = not_a_number}, Message{.energy_J = not_a_number}}) {
    WaveSlave slave = slave_of({});
    EXPECT_TRUE(std::isnan(slave.step({.arrival = {.message = message, .fresh = true}}).motor_force_N));
  }
}

TEST(WaveVariables, ErrorsNameTheKeyOfTheFile) {
  ControlParams params;
  params.architecture = "wave-variables";
  params.own<WaveParams>().cutoff_Hz = 3000.0;
  EXPECT_EQ(make_sites(params, Seconds{tick_s}).error().parameter, "wave.cutoff_Hz");
  params.own<WaveParams>() = {};
  params.force_gain = 0.0;
  EXPECT_EQ(make_sites(params, Seconds{tick_s}).error().parameter, "force_gain");
}

}  // namespace wave_variables_test
}  // namespace tactus::control
