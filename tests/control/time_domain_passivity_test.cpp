// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/time_domain_passivity.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/control/random_line.hpp"
#include <gtest/gtest.h>

namespace tactus::control {
namespace time_domain_passivity_test {

static_assert(Element<PassivityMaster>);
static_assert(Element<PassivitySlave>);

constexpr double tick_s = 200e-6;

PassivityMaster::Params plain_master() {
  PassivityMaster::Params params;
  params.display.cancellation = CancellationMode::off;
  params.display.force_limit_N = 10.0;
  return params;
}

/// A slave whose motor force is the position that its servo follows: its motor stays at 0.
PassivitySlave::Params bare_slave() {
  PassivitySlave::Params params;
  params.slave.proportional_N_per_m = 1.0;
  params.slave.derivative_N_s_per_m = 0.0;
  return params;
}

PassivityMaster master_of(const PassivityMaster::Params& params) {
  return PassivityMaster::make(params, Seconds{tick_s}).value();
}
PassivitySlave slave_of(const PassivitySlave::Params& params) {
  return PassivitySlave::make(params, Seconds{tick_s}).value();
}

TEST(PassivityMaster, IsThePublishedObserverAndControllerOfImpedanceType) {
  PassivityMaster::Params params = plain_master();
  params.display.force_gain = 2.0;
  params.display.position_scale = 0.5;
  params.passivity.damping_limit_N_s_per_m = 1000.0;
  PassivityMaster site = master_of(params);
  auto derivative = signal::FilteredDerivative::make(params.passivity.velocity, Seconds{tick_s}).value();
  Draw draw(11);
  RandomMotion hand(draw, 4e-5, true);

  double E_in = 0.0, E_out = 0.0, E_PC = 0.0, arrived_J = 0.0;  // J at the slave's scale
  double x_before = 0.0, f_hat = 0.0, f_PC = 0.0;
  int active = 0;
  for (int k = 0; k < 5000; ++k) {
    const double x = hand.step();
    const double reflected = 0.5 * std::sin(0.004 * k);
    arrived_J += draw.between(0.0, 2e-8);
    // The paper's update in the variables of the line: velocity 0.5 v, force f / 2, forces against the hand positive.
    if (k > 0) {
      const double dx = 0.5 * (x - x_before);
      const double in = f_hat * dx;
      if (in > 0.0)
        E_in += in;
      else
        E_out -= in;
      E_PC += f_PC * dx;
    }
    x_before = x;
    const double v = 0.5 * derivative.step(x);
    const double W = arrived_J - E_out + E_PC;
    const double alpha = W < 0.0 && v != 0.0 ? -W / (tick_s * v * v) : 0.0;
    f_hat = reflected;
    // The limit: 1000 N s/m at the motor are as many in the line, 2 · 0.5; a driving force may always be cancelled.
    f_PC = std::min(alpha, std::max(1000.0, f_hat * v < 0.0 ? -f_hat / v : 0.0)) * v;
    if (alpha > 0.0) ++active;

    const auto out = site.step(
        {.motor_position_m = x, .arrival = {.message = {.force_N = reflected, .energy_J = arrived_J}, .fresh = true}});
    ASSERT_NEAR(-out.motor_force_N, 2.0 * (f_hat + f_PC), 1e-9) << k;
    ASSERT_NEAR(out.message.energy_J, E_in, 1e-12) << k;
    ASSERT_EQ(out.message.position_m, 0.5 * x);
  }
  EXPECT_GT(active, 200);
  EXPECT_LT(active, 4800);
}

TEST(PassivitySlave, IsThePublishedObserverAndControllerOfAdmittanceType) {
  PassivitySlave::Params params = bare_slave();
  params.passivity.recovery_time_s = 0.02;
  PassivitySlave site = slave_of(params);
  Draw draw(5);
  RandomMotion commands(draw, 4e-5, true);
  double E_in = 0.0, E_out = 0.0, E_PC = 0.0, arrived_J = 0.0;
  double command_before = 0.0, x_sd = 0.0;
  int active = 0;
  for (int k = 0; k < 5000; ++k) {
    const double command = commands.step();
    if (k == 0) command_before = x_sd = command;
    const double f = 0.5 * std::sin(0.004 * k);
    arrived_J += draw.between(0.0, 2e-6);
    // The velocity that is asked for: the master's, and what closes the distance in 0.02 s.
    const double v_hat = (command - command_before) / tick_s + (command_before - x_sd) / 0.02;
    command_before = command;
    const double out_J = f * v_hat * tick_s;
    if (out_J > 0.0)
      E_out += out_J;
    else
      E_in -= out_J;
    const double W = arrived_J - E_out + E_PC;
    const double beta = W < 0.0 && f != 0.0 ? -W / (tick_s * f * f) : 0.0;
    E_PC += tick_s * beta * f * f;
    x_sd += tick_s * (v_hat - beta * f);
    if (beta > 0.0) ++active;

    const auto out = site.step({.motor_position_m = 0.0,
                                .tip_force_N = f,
                                .arrival = {.message = {.position_m = command, .energy_J = arrived_J}, .fresh = true}});
    ASSERT_NEAR(out.motor_force_N, x_sd, 1e-12) << k;
    ASSERT_NEAR(out.message.energy_J, E_in, 1e-12) << k;
    ASSERT_EQ(out.message.force_N, f);
  }
  EXPECT_GT(active, 200);
  EXPECT_LT(active, 4800);
}

/// How far the balances fell below zero at the worst: of the slave's port, which may give what it is told that the
/// other took up, and of both ports together.
struct Worst {
  double slave_J = 0.0;
  double line_J = 0.0;       ///< of both ports together
  double tick_work_J = 0.0;  ///< the most that the master's port gave in one tick
  double turnover_J = 0.0;
};

/// `controlled` or, for comparison, plain position-force on the same line.
Worst worst_of(std::uint64_t seed, bool controlled) {
  Draw draw(seed);
  PassivityMaster::Params params = plain_master();
  params.display.force_gain = draw.between(0.2, 5.0);
  params.display.position_scale = draw.between(0.3, 3.0);
  params.passivity.damping_limit_N_s_per_m = 300.0;
  PassivityMaster master = master_of(params);
  PassivitySlave slave = slave_of(bare_slave());
  PositionForceMaster plain = PositionForceMaster::make(params.display, Seconds{tick_s}).value();
  RandomLine to_slave = RandomLine::any(draw);
  RandomLine to_master = RandomLine::any(draw);
  RandomMotion hand(draw, draw.between(2e-6, 4e-5), true);
  const double wall_N_per_m = draw.between(50.0, 2000.0);
  const double scale = params.display.position_scale / params.display.force_gain;

  Worst worst;
  Arrival back;
  double hand_before_m = 0.0, held_N = 0.0, wanted_m = 0.0, force_N = 0.0;
  double at_master_J = 0.0, at_slave_J = 0.0;  // taken up by the line, net
  for (int tick = 0; tick < 6000; ++tick) {
    const double hand_m = hand.step();
    if (tick > 0) {
      const double work_J = -scale * held_N * (hand_m - hand_before_m);
      at_master_J += work_J;
      worst.tick_work_J = std::max(worst.tick_work_J, -work_J);
      worst.turnover_J += std::fabs(work_J);
    }
    hand_before_m = hand_m;
    const MasterInput input{.motor_position_m = hand_m, .arrival = back};
    const auto out = controlled ? master.step(input) : plain.step(input);
    held_N = out.motor_force_N;
    // A spring with a grain of noise on its sensor.
    force_N = wall_N_per_m * wanted_m + draw.between(-0.005, 0.005);
    const Arrival forth = to_slave.step(out.message);
    auto answer = slave.step({.motor_position_m = 0.0, .tip_force_N = force_N, .arrival = forth});
    if (!controlled) answer.motor_force_N = forth.message.position_m;
    if (tick > 0) {
      const double work_J = -force_N * (answer.motor_force_N - wanted_m);
      at_slave_J += work_J;
      worst.turnover_J += std::fabs(work_J);
    }
    wanted_m = answer.motor_force_N;
    worst.slave_J = std::min(worst.slave_J, at_slave_J + forth.message.energy_J);
    worst.line_J = std::min(worst.line_J, at_master_J + at_slave_J);
    back = to_master.step(answer.message);
  }
  return worst;
}

TEST(TimeDomainPassivity, NoLineGivesMoreThanItTookUpButForOneTickOfTheHeldForce) {
  int active = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Worst worst = worst_of(seed, true);
    EXPECT_GE(worst.slave_J, -1e-12 * worst.turnover_J) << "seed " << seed;
    EXPECT_GE(worst.line_J, -4.0 * worst.tick_work_J - 1e-12) << "seed " << seed;
    const Worst plain = worst_of(seed, false);
    if (plain.line_J < -40.0 * plain.tick_work_J) ++active;
  }
  EXPECT_GE(active, 20) << "plain position-force was hardly ever active, so there was nothing to do";
}

TEST(PassivitySlave, ReflectsTheForceThatItIsToldTo) {
  PassivitySlave::Params params = bare_slave();
  params.passivity.reflected_force = ReflectedForce::servo;
  PassivitySlave slave = slave_of(params);
  (void)slave.respond({.motor_position_m = 0.0, .tip_force_N = 0.3, .arrival = {}});
  slave.applied(0.125);
  EXPECT_EQ(slave.respond({.motor_position_m = 0.0, .tip_force_N = 0.3, .arrival = {}}).message.force_N, 0.125);
}

TEST(PassivitySlave, ASlipIsClosedInTheRecoveryTimeOnceNothingHoldsIt) {
  PassivitySlave::Params params = bare_slave();
  params.passivity.recovery_time_s = 0.02;
  PassivitySlave slave = slave_of(params);
  const auto at = [&](double command_m, double force_N) {
    return slave.step({.tip_force_N = force_N, .arrival = {.message = {.position_m = command_m}, .fresh = true}})
        .motor_force_N;
  };
  EXPECT_EQ(at(0.0, 0.0), 0.0);
  EXPECT_NEAR(at(0.01, 1.0), 0.0, 1e-15) << "no energy arrived, so against a force it may not move";
  double wanted_m = 0.0;
  for (int tick = 0; tick < 100; ++tick) wanted_m = at(0.01, 0.0);
  EXPECT_NEAR(wanted_m, 0.01 * (1.0 - std::exp(-1.0)), 5e-5);
}

TEST(TimeDomainPassivity, AnEnergyThatIsNotANumberReachesTheGate) {
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
  PassivityMaster master = master_of(plain_master());
  (void)master.step({});
  const auto out =
      master.step({.motor_position_m = 1e-4, .arrival = {.message = {.energy_J = not_a_number}, .fresh = true}});
  EXPECT_TRUE(std::isnan(out.motor_force_N));
}

TEST(TimeDomainPassivity, ErrorsNameTheKeyOfTheFile) {
  ControlParams params;
  params.architecture = "time-domain-passivity";
  params.force_gain = 0.0;
  EXPECT_EQ(make_sites(params, Seconds{tick_s}).error().parameter, "force_gain");
  params.force_gain = 1.0;
  params.own<PassivityParams>().velocity.cutoff_Hz = 4000.0;
  EXPECT_EQ(make_sites(params, Seconds{tick_s}).error().parameter, "passivity.velocity.cutoff_Hz");
}

}  // namespace time_domain_passivity_test
}  // namespace tactus::control
