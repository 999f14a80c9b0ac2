// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/params.hpp>

namespace tactus::experiments {

FaultsParams::FaultsParams() {
  environment.stiffness_N_per_m = 40000.0;
  environment.damping_N_s_per_m = 3.0;
  slave.force_sensor.noise_rms_N = 0.002;
  plant.longest_step_s = 50e-6;
  control.force_gain = 5.0;
  control.force_limit_N = 3.0;
  control.slave.proportional_N_per_m = 100.0;
  control.slave.derivative_N_s_per_m = 0.65;
  for (control::SafetyGate::Params* gate : {&control.gate, &control.slave_gate}) {
    gate->force_limit_N = 5.0;
    gate->rate_limit_N_per_s = 2000.0;
    gate->velocity_limit_m_per_s = 2.0;
    gate->position_limit_m = 0.2;
    gate->encoder.fastest_m_per_s = 5.0;
    gate->encoder.frozen_force_N = 0.3;
    gate->energy = {
        .damp_above_J = 0.02, .hold_above_J = 0.05, .credit_J = 0.02, .drain_W = 0.05, .damping_N_s_per_m = 3.0};
    // Neither a wall that throws the slave back nor a hand that pushes against the display gets there.
    gate->reversal = {.force_N = 0.3, .gained_m_per_s = 0.1, .lasting_s = 0.003};
    gate->thermal = {.continuous_force_N = 2.0, .time_constant_s = 10.0};
  }
  // A hand that turns around dwells within a count for up to 40 ms, and one that pushes as fast as the force grows was
  // seen to for 76 ms: docs/theory/safety.md.
  control.gate.encoder.frozen_after_s = 0.1;
  // More than twice the friction of the slave, and by then 12 counts away.
  control.slave_gate.encoder.unbalanced_force_N = 0.06;
  control.slave_gate.encoder.frozen_after_s = 0.015;
  control.handle_gate.rate_limit_N_per_s = 2000.0;
  control.supervision.force_sensor.residual_limit_N = 0.5;
  control.supervision.hand_sensor.residual_limit_N = 0.6;
  control.supervision.hold.release_s = 0.3;
}

}  // namespace tactus::experiments
