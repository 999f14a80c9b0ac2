// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/mechanics/cable_driven_master.hpp>
#include <tactus/kernel/mechanics/electric_slave.hpp>
#include <tactus/kernel/mechanics/operator.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/simulation/teleoperator/clock.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>

/// What is at each site of a simulated teleoperator. A tick of a plant: `read`, then `write` the command that
/// follows, then `begin_tick` and its substeps in order. A command acts after the computation delay; until then the one
/// before it does. All of it is real-time safe but `make`.
namespace tactus::simulation {

/// The master device and the operator who holds it.
class MasterPlant {
 public:
  /// At rest with every mass at `start_m`. Errors name `master` and `operator`.
  static Result<MasterPlant> make(const mechanics::CableDrivenMaster::Params& device,
                                  const mechanics::Operator::Params& person, const Clock& clock, double start_m);

  /// What the sensors read at this tick. The operator changes the grip here.
  station::DeviceReading read(const station::Tick&) noexcept;
  void write(const station::DeviceCommand& command) noexcept {
    next_ = {.motor_N = command.force_N, .handle_N = command.handle_force_N};
  }
  /// The operator intends to be at `path_m` now and at `path_at_next_tick_m` then.
  void begin_tick(double path_m, double path_at_next_tick_m) noexcept {
    begin_tick(person_.step({.path_m = path_m,
                             .path_at_next_tick_m = path_at_next_tick_m,
                             .handle_position_m = device_.mechanism().tip_position_m()}));
  }
  /// What holds the handle wants it at `aim`, as a clamp does, which corrects nothing.
  void begin_tick(const mechanics::Operator::Output& aim) noexcept {
    aim_ = aim;
    ++ticks_;
  }
  /// The operator holds the handle as that of `other` is held, from the next substep on, and the other way round.
  void exchange_grip(MasterPlant& other) noexcept {
    std::swap(grip_, other.grip_);
    device_.hold(mechanics::scaled(grip_, grip_factor_));
  }
  /// The operator holds the handle with `grip` from the next substep on, which must be one that `make` takes.
  void hold(const mechanics::LinearSpring::Params& grip) noexcept {
    grip_ = grip;
    device_.hold(mechanics::scaled(grip_, grip_factor_));
  }
  /// The same after nobody held it, or something else did: what the operator corrected before is forgotten.
  void take_again(const mechanics::LinearSpring::Params& grip) noexcept {
    person_.reset();
    hold(grip);
  }
  void substep(int index) noexcept {
    if (index == clock_.late_substeps) command_ = next_;
    const double middle_s = (index + 0.5) * clock_.substep_s;
    const auto moved = device_.step({.commanded_force_N = command_.motor_N,
                                     .commanded_handle_force_N = command_.handle_N,
                                     .grip_position_m = aim_.position_m + middle_s * aim_.velocity_m_per_s,
                                     .grip_velocity_m_per_s = aim_.velocity_m_per_s});
    hand_force_N_ = moved.grip_force_N;
  }
  /// The true force of the hand on the handle in the latest substep, positive toward the environment.
  [[nodiscard]] double hand_force_N() const noexcept { return hand_force_N_; }
  [[nodiscard]] const mechanics::CableChain& mechanism() const noexcept { return device_.mechanism(); }

 private:
  /// Commanded of its two actuators.
  struct Forces {
    double motor_N = 0.0;
    double handle_N = 0.0;
  };

  MasterPlant(const mechanics::CableDrivenMaster& device, const mechanics::Operator& person,
              const mechanics::Operator::Params& params, const Clock& clock)
      : device_(device), person_(person), clock_(clock), grip_(params.grip), grip_change_(params.grip_change) {}

  mechanics::CableDrivenMaster device_;
  mechanics::Operator person_;
  Clock clock_;
  mechanics::LinearSpring::Params grip_;  ///< before any change
  mechanics::Operator::GripChange grip_change_;
  double grip_factor_ = 1.0;
  std::int64_t ticks_ = 0;
  Forces command_;
  Forces next_;
  mechanics::Operator::Output aim_;
  double hand_force_N_ = 0.0;
};

/// The slave device before its wall.
class SlavePlant {
 public:
  /// What happened at the tip in a tick.
  struct Contact {
    double sum_N = 0.0;            ///< of the true force over the substeps so far
    double peak_N = 0.0;           ///< of the largest substep
    bool touched = false;          ///< the tip met the wall
    int touched_substep = 0;       ///< in which substep first
    double touched_after_s = 0.0;  ///< when, from the begin of that substep
  };

  /// At rest with every mass at `start_m`. Errors name `slave` and `environment`.
  static Result<SlavePlant> make(const mechanics::ElectricSlave::Params& device,
                                 const mechanics::Environment::Params& environment, const Clock& clock, double start_m);

  /// What the sensors read at this tick.
  station::DeviceReading read(const station::Tick&) noexcept {
    const mechanics::ElectricSlave::Reading reading = device_.measure();
    return {.position_m = reading.motor_position_m, .force_N = reading.tip_force_N};
  }
  void write(const station::DeviceCommand& command) noexcept { next_N_ = command.force_N; }
  void begin_tick() noexcept { contact_ = {}; }
  void substep(int index) noexcept {
    if (index == clock_.late_substeps) command_N_ = next_N_;
    const auto contact = device_.step(command_N_);
    contact_.sum_N += contact.contact_force_N;
    contact_.peak_N = std::max(contact_.peak_N, contact.contact_force_N);
    if (contact.touched && !contact_.touched) {
      contact_.touched = true;
      contact_.touched_substep = index;
      contact_.touched_after_s = contact.touched_after_s;
    }
  }
  /// Faces the wall of `other` from the next substep on, and the other way round.
  void exchange_wall(SlavePlant& other) noexcept {
    const mechanics::Environment wall = device_.environment();
    device_.face(other.device_.environment());
    other.device_.face(wall);
  }
  /// Since `begin_tick`.
  [[nodiscard]] const Contact& contact() const noexcept { return contact_; }
  [[nodiscard]] double tip_position_m() const noexcept { return device_.mechanism().tip_position_m(); }
  [[nodiscard]] const mechanics::CableChain& mechanism() const noexcept { return device_.mechanism(); }

 private:
  SlavePlant(const mechanics::ElectricSlave& device, const Clock& clock) : device_(device), clock_(clock) {}

  mechanics::ElectricSlave device_;
  Clock clock_;
  double command_N_ = 0.0;
  double next_N_ = 0.0;
  Contact contact_;
};

}  // namespace tactus::simulation
