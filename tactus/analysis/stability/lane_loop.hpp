// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/model/induced_motion_step.hpp>
#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/mechanics/amplifier.hpp>
#include <tactus/kernel/mechanics/cable_chain.hpp>
#include <tactus/kernel/mechanics/contact.hpp>
#include <tactus/kernel/mechanics/encoder.hpp>
#include <tactus/kernel/mechanics/operator.hpp>
#include <tactus/kernel/mechanics/tip_at_wall.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>
#include <tactus/kernel/signal/sections.hpp>

#include <cstddef>

/// The closed loop that a map runs: what `simulation::Teleoperator` does with a position-force architecture,
/// Kelvin–Voigt wall, channels of constant delay and sensors without noise, made of the same arithmetic, on a scalar or
/// on lanes.
namespace tactus::stability {

/// A wall as `mechanics::TipAtWall` wants it.
template <class Scalar>
struct LaneWall {
  Scalar surface_m{}, stiffness_N_per_m{}, damping_N_s_per_m{};
  [[nodiscard]] Scalar position_m() const noexcept { return surface_m; }
  [[nodiscard]] Scalar force_N(const Scalar& tip_m, const Scalar& velocity_m_per_s) const noexcept {
    return mechanics::kelvin_voigt_force_N<Scalar>(stiffness_N_per_m, damping_N_s_per_m, tip_m - surface_m,
                                                   velocity_m_per_s);
  }
};

/// A safety gate, but for its latch: a force that is not finite ends the run anyway.
template <class Scalar>
struct LaneGate {
  Scalar force_limit_N{}, largest_step_N{};
  Scalar passed_N{};
  Scalar step(const Scalar& command_N) noexcept {
    const Scalar wanted = clamped<Scalar>(command_N, -force_limit_N, force_limit_N);
    return passed_N = clamped<Scalar>(wanted, passed_N - largest_step_N, passed_N + largest_step_N);
  }
};

/// A minimum-jerk reach that begins at time zero, as `mechanics::MinimumJerk`.
template <class Scalar>
struct LanePath {
  Scalar start_m{}, stroke_m{}, duration_s{};
  [[nodiscard]] Scalar position_m(double time_s) const noexcept {
    const Scalar s = clamped<Scalar>(time_s / duration_s, Scalar(0.0), Scalar(1.0));
    return start_m + stroke_m * s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
  }
};

/// What is the same for all lanes of a block.
struct LoopClock {
  double tick_s = 0.0;
  int substeps = 1;
  int late_substeps = 0;
  bool operator==(const LoopClock&) const = default;
};

/// Parameters and state of one loop. Made of scalars alone, so that the numbers of as many loops as there are lanes,
/// transposed, are those of one loop on lanes.
template <class Scalar>
struct LaneLoop {
  mechanics::CableChainMotion<Scalar> master;
  mechanics::CurrentAmplifierMotion<Scalar> master_amplifier;
  Scalar master_resolution_m{};
  mechanics::CableChainMotion<Scalar> slave;
  mechanics::CurrentAmplifierMotion<Scalar> slave_amplifier;
  Scalar slave_resolution_m{};
  LaneWall<Scalar> wall;
  signal::SecondOrderSection<Scalar> sensor;
  Scalar sensor_offset_N{}, sensor_limit_N{}, analogue_N{};
  control::InducedMotionStep<Scalar> model;
  signal::FilteredDerivativeMotion<Scalar> intended_velocity;
  Scalar cancels{};     ///< 1 with cancellation in the command path, else 0
  Scalar hysteretic{};  ///< 1 where the model's linkage is, else 0
  Scalar position_scale{}, force_gain{}, force_limit_N{};
  Scalar proportional_N_per_m{}, derivative_N_s_per_m{};
  signal::FilteredDerivativeMotion<Scalar> error_rate;
  LaneGate<Scalar> master_gate, slave_gate;
  mechanics::OperatorMotion<Scalar> person;
  LanePath<Scalar> path;
  Scalar substep_s{};
  Scalar master_command_N{}, slave_command_N{};
  Scalar arrived_force_N{};  ///< at the master, for its next tick

  /// What one tick showed.
  struct Record {
    Scalar contact_force_N{};       ///< mean until the next tick
    Scalar peak_contact_force_N{};  ///< largest substep
    Scalar touches{};               ///< times that the tip met the wall
    Scalar master_position_m{};     ///< measured
    Scalar tip_position_m{};        ///< of the slave
  };

  /// One tick, in the order of `simulation::Teleoperator::step`. The lines carry what the ways between the parts delay.
  template <class Lines>
  Record tick(const LoopClock& clock, double time_s, Lines& lines, bool cancelling, bool any_hysteretic) noexcept {
    const Scalar master_m = mechanics::quantised<Scalar>(master.state.position_m[0], master_resolution_m);
    const Scalar slave_m = mechanics::quantised<Scalar>(slave.state.position_m[0], slave_resolution_m);
    const Scalar tip_N = clamped<Scalar>(analogue_N + sensor_offset_N, -sensor_limit_N, sensor_limit_N);

    // Master site.
    const Scalar displayed_N = clamped<Scalar>(force_gain * arrived_force_N, -force_limit_N, force_limit_N);
    Scalar command_m = master_m;
    Scalar velocity_m_per_s{};
    if (cancelling) {
      const Scalar intended_m = master_m - model.state[0];
      velocity_m_per_s = intended_velocity.step(intended_m);
      command_m = select(cancels > 0.0, intended_m, master_m);
    }
    const Scalar motor_N = master_gate.step(-displayed_N);
    if (cancelling) model.advance(motor_N, Scalar(0.0), model.friction_range(velocity_m_per_s), any_hysteretic);

    // Slave site.
    const Scalar error_m = lines.to_slave(position_scale * command_m) - slave_m;
    const Scalar servo_N =
        slave_gate.step(proportional_N_per_m * error_m + derivative_N_s_per_m * error_rate.step(error_m));
    arrived_force_N = lines.to_master(tip_N);

    Record record{.contact_force_N = 0.0,
                  .peak_contact_force_N = 0.0,
                  .touches = 0.0,
                  .master_position_m = master_m,
                  .tip_position_m = slave.state.position_m[2]};
    const Scalar path_m = path.position_m(time_s), next_m = path.position_m(time_s + clock.tick_s);
    const auto aim = person.step(path_m, next_m, lines.reaction(person.felt(master.state.position_m[2], path_m)));
    mechanics::TipAtWall<Scalar, LaneWall<Scalar>> tip(slave, wall, substep_s);
    for (int i = 0; i < clock.substeps; ++i) {
      if (i == clock.late_substeps) {
        master_command_N = motor_N;
        slave_command_N = servo_N;
      }
      const Scalar middle_s = (i + 0.5) * substep_s;
      master.advance({.motor_force_N = master_amplifier.step(master_command_N),
                      .tip_force_N = 0.0,
                      .grip_position_m = aim.position_m + middle_s * aim.velocity_m_per_s,
                      .grip_velocity_m_per_s = aim.velocity_m_per_s},
                     master.step);
      const auto contact = tip.step(slave_amplifier.step(slave_command_N));
      using std::max;
      analogue_N = sensor.step(contact.contact_force_N);
      record.contact_force_N += contact.contact_force_N;
      record.peak_contact_force_N = max(record.peak_contact_force_N, contact.contact_force_N);
      record.touches += contact.touched;
    }
    record.contact_force_N = record.contact_force_N / Scalar(clock.substeps);
    return record;
  }
};

}  // namespace tactus::stability
