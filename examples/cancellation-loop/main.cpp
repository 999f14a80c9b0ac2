// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/stages/cancellation.hpp>
#include <tactus/kernel/mechanics/cable_driven_master.hpp>
#include <tactus/kernel/mechanics/operator.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

/// What the controller assumes of the leader and of the hand that holds it: the joystick of paper A, Table I. Write the
/// values of your own leader here, all in SI units at the hand, or read them from a model file with
/// `tactus::configuration::read_cancellation`.
tactus::control::MasterModel model_of_the_leader() {
  tactus::control::MasterModel model;
  model.motor = {.mass_kg = 0.0075, .friction_N = 0.01};
  model.cable = {.stiffness_N_per_m = 39500.0, .damping_N_s_per_m = 3.6};
  model.drum = {.mass_kg = 0.01075, .friction_N = 0.0144};
  model.linkage.stiffness_N_per_m = 3950.0;
  model.linkage.damping_N_s_per_m = 0.02;
  model.linkage.hysteretic_fraction = 0.3;
  model.linkage.slip_deflection_m = 65e-6;
  model.linkage.reference_deflection_m = 250e-6;
  model.handle = {.mass_kg = 0.014};
  model.hand.stiffness_N_per_m = 40.0;
  model.hand.damping_N_s_per_m = 23.0;
  model.hand.quintic_stiffness_N_per_m5 = 3.125e13;
  return model;
}

/// A servo loop of one's own around `Cancellation` alone. A hand moves a simulated master at 50 mm/s while impacts of
/// 1 N and 10 ms are displayed to it, ten in a second. The same hand moves the same master without them: what the
/// operator intended.
int main() {
  constexpr double tick_s = 200e-6;
  constexpr int substeps = 20;
  const auto hand = tactus::mechanics::Operator::Params{}.grip;
  auto cancellation =
      tactus::control::Cancellation::make({.model = {.master = model_of_the_leader()}}, tactus::Seconds{tick_s});
  auto master = tactus::mechanics::CableDrivenMaster::make({}, hand, tactus::Seconds{tick_s / substeps});
  if (!cancellation || !master) return 1;
  auto undisturbed = *master;  // everything in tactus is a value: a copy is a fork
  double moved_m = 0.0, left_m = 0.0;
  for (int tick = 0; tick < 5000; ++tick) {
    const double phase = std::fmod(tick * tick_s, 0.1) / 0.01;
    const double displayed_N = phase < 1.0 ? std::sin(3.14159 * phase) : 0.0;

    const double measured_m = master->measure().motor_position_m;
    const double intended_m = cancellation->intended(measured_m);  // the position to send to the slave
    cancellation->advance(-displayed_N);                           // a force that pushes the hand back is negative

    const double meant_m = undisturbed.measure().motor_position_m;
    moved_m = std::max(moved_m, std::abs(measured_m - meant_m));
    left_m = std::max(left_m, std::abs(intended_m - meant_m));
    for (int i = 0; i < substeps; ++i) {
      const double hand_m = 0.05 * tick_s * (tick + static_cast<double>(i) / substeps);
      master->step({.commanded_force_N = -displayed_N, .grip_position_m = hand_m, .grip_velocity_m_per_s = 0.05});
      undisturbed.step({.grip_position_m = hand_m, .grip_velocity_m_per_s = 0.05});
    }
  }
  std::printf("The impacts moved the motor by up to %.0f um, and the command to a slave by up to %.0f um.\n",
              1e6 * moved_m, 1e6 * left_m);
}
