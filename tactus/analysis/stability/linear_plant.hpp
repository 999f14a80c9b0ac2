// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/linearisation.hpp>
#include <tactus/analysis/stability/state_space.hpp>
#include <tactus/kernel/mechanics/cable_driven_master.hpp>
#include <tactus/kernel/mechanics/electric_slave.hpp>

/// Linear models of the devices in continuous time, from the parameters that describe the simulated ones.
namespace tactus::stability {

/// A spring and damper from the tip to the ground: a hand, or a wall. Nobody and nothing is all zeros.
using TipLoad = mechanics::LinearSpring::Params;

/// The wall about `preload_N`, found from what the environment's law answers to small changes of depth and rate.
TipLoad wall_load(const mechanics::Environment::Params& wall, double preload_N);

/// Inputs of a device: the amplifier's command, then a force on the tip from outside, both in N and positive toward
/// the environment.
enum DeviceInput : Eigen::Index { command_in, tip_force_in, device_inputs };
/// Outputs of a device: positions of motor and tip in m, velocity of the tip in m/s, and what its force sensor states
/// about the force in N on the tip: of a slave that with which load and outside push the tip back, of a master that
/// with which the hand pushes it forward, which is the same with the other sign. Here: pushes back.
enum DeviceOutput : Eigen::Index { motor_out, tip_out, tip_velocity_out, sensor_out, device_outputs };

/// The place of a further input of a device with an actuator on its tip: the actuator's command in N, same sign.
inline constexpr Eigen::Index tip_command_in = device_inputs;

/// Amplifier, motor, cable, drum, linkage and tip; the sensor as the analogue second-order low-pass that its sampled
/// form stands for. Saturation, quantisation, noise and offset are left out.
StateSpace linear_device(const mechanics::CableChain::Params& mechanism,
                         const mechanics::CurrentAmplifier::Params& amplifier, double sensor_bandwidth_Hz,
                         const TipLoad& load, const Linearisation& linearisation);

/// A master with the actuator on its handle: `linear_device` with the input `tip_command_in`.
StateSpace linear_master(const mechanics::CableDrivenMaster::Params& master, const TipLoad& load,
                         const Linearisation& linearisation);

/// From the commands of both actuators of such a master, that of the motor first, to the motor's position.
StateSpace driven(const StateSpace& master);

}  // namespace tactus::stability
