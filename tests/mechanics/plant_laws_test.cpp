// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/cable_chain.hpp>
#include <tactus/kernel/mechanics/cable_driven_master.hpp>
#include <tactus/kernel/mechanics/electric_slave.hpp>
#include <tactus/kernel/mechanics/environment.hpp>
#include <tactus/kernel/mechanics/operator.hpp>
#include <tactus/kernel/mechanics/position_transducer.hpp>
#include <tactus/kernel/mechanics/pressure_sensor.hpp>
#include <tactus/kernel/mechanics/servo_hydraulic_slave.hpp>
#include <tactus/kernel/mechanics/servo_valve.hpp>

#include "tests/laws.hpp"

namespace tactus::laws {

/// Plants run on substeps of the servo tick.
struct OnSubsteps {
  static constexpr double dt_s = 40e-6;
};

template <>
struct Subject<mechanics::CableChain> : OnSubsteps {
  static std::vector<mechanics::CableChain::Params> parameters() {
    return {{},
            {.motor = {.mass_kg = 0.0075, .friction_N = 0.0},
             .drum = {.mass_kg = 0.01075, .friction_N = 0.0},
             .linkage = {.hysteretic_fraction = 0.0}}};
  }
  static void admit(mechanics::CableChain::Input&) {}
};

template <>
struct Subject<mechanics::Environment> : OnSubsteps {
  static std::vector<mechanics::Environment::Params> parameters() {
    return {{.law = mechanics::ContactLaw::kelvin_voigt},
            {.law = mechanics::ContactLaw::hunt_crossley, .position_m = 0.25}};
  }
  static void admit(mechanics::Environment::Input&) {}
};

template <>
struct Subject<mechanics::CableDrivenMaster> : OnSubsteps {
  static std::vector<mechanics::CableDrivenMaster::Params> parameters() { return {{}}; }
  static void admit(mechanics::CableDrivenMaster::Input&) {}
};

/// A wall in the way, that the tip hits and leaves.
template <>
struct Subject<mechanics::ElectricSlave> : OnSubsteps {
  static std::vector<mechanics::ElectricSlave::Params> parameters() {
    mechanics::ElectricSlave::Params noisy;
    noisy.force_sensor.noise_rms_N = 0.02;
    return {{}, noisy};
  }
  static void admit(double&) {}
};

template <>
struct Doubles<mechanics::ElectricSlave::Output> {
  using Row = std::array<double, 3>;
  static Row to(const mechanics::ElectricSlave::Output& output) {
    return {output.contact_force_N, output.touched ? 1.0 : 0.0, output.touched_after_s};
  }
};

template <>
struct Subject<mechanics::Operator> {
  static constexpr double dt_s = 200e-6;
  static std::vector<mechanics::Operator::Params> parameters() {
    return {{},
            {.grip_change = {}, .correction = {.reaction_time_s = 0.0}, .tremor_phase_cycles = 0.3},
            {.grip_change = {}, .correction = {.gain_per_s = 0.0}, .tremor_amplitude_m = 0.0}};
  }
  static void admit(mechanics::Operator::Input&) {}
};

/// The stiff oil asks for finer substeps.
struct OnFineSubsteps {
  static constexpr double dt_s = 10e-6;
};

template <>
struct Subject<mechanics::ServoValve> : OnFineSubsteps {
  static std::vector<mechanics::ServoValve::Params> parameters() { return {{}}; }
  static void admit(double&) {}
};

template <>
struct Subject<mechanics::ServoHydraulicSlave> : OnFineSubsteps {
  static std::vector<mechanics::ServoHydraulicSlave::Params> parameters() { return {{}}; }
  static void admit(double&) {}
};

template <>
struct Subject<mechanics::PressureSensor> : OnSubsteps {
  static std::vector<mechanics::PressureSensor::Params> parameters() { return {{}}; }
  static void admit(double&) {}
};

template <>
struct Subject<mechanics::PositionTransducer> : OnSubsteps {
  static std::vector<mechanics::PositionTransducer::Params> parameters() { return {{}}; }
  static void admit(double&) {}
};

using Plants =
    ::testing::Types<mechanics::CableChain, mechanics::Environment, mechanics::CableDrivenMaster,
                     mechanics::ElectricSlave, mechanics::Operator, mechanics::ServoValve,
                     mechanics::ServoHydraulicSlave, mechanics::PressureSensor, mechanics::PositionTransducer>;
INSTANTIATE_TYPED_TEST_SUITE_P(Plants, ElementLaws, Plants);

}  // namespace tactus::laws
