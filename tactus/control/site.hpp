#pragma once

/// What the two sites of a teleoperator measure, command and tell one another. One axis each; positions and forces are
/// positive toward the environment unless said otherwise.
namespace tactus::control {

/// What the master's sensors read at a tick.
struct MasterMeasurement {
  double motor_position_m = 0.0;
};

/// What the slave's sensors read at a tick.
struct SlaveMeasurement {
  double motor_position_m = 0.0;
  double tip_force_N = 0.0;  ///< positive when the environment pushes the slave back
};

/// From master to slave.
struct MasterMessage {
  double position_command_m = 0.0;
};

/// From slave to master.
struct SlaveMessage {
  double tip_force_N = 0.0;  ///< positive when the environment pushes the slave back
};

}  // namespace tactus::control
