// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/hydraulic_cylinder.hpp>
#include <tactus/kernel/mechanics/position_transducer.hpp>
#include <tactus/kernel/mechanics/pressure_sensor.hpp>
#include <tactus/kernel/mechanics/servo_valve.hpp>

namespace tactus::mechanics {

/// The slave of paper B's rig as a plant: current → servo valve → cylinder with load, with a pressure sensor in each
/// chamber and a position transducer on the rod (paper B, Fig. 6). What it can push against are its end stops, which is
/// the paper's rigid contact. It runs on the plant's substeps; the sensors are read at the servo tick.
class ServoHydraulicSlave {
 public:
  struct Params {
    ServoValve::Params valve;
    HydraulicCylinder::Params cylinder;
    PressureSensor::Params first_pressure{.seed = 3};
    PressureSensor::Params second_pressure{.seed = 4};
    PositionTransducer::Params position;
    static constexpr auto fields() {
      return List{field("valve", &Params::valve, "Servo valve."),
                  field("cylinder", &Params::cylinder, "Cylinder and load."),
                  field("first_pressure", &Params::first_pressure, "Pressure sensor of the first chamber."),
                  field("second_pressure", &Params::second_pressure, "Pressure sensor of the second chamber."),
                  field("position", &Params::position, "Position transducer of the rod.")};
    }
  };
  /// Current of the valve in mA, positive toward +x.
  using Input = double;
  struct Output {
    double position_m = 0.0;        ///< true, from mid-stroke
    double pressure_force_N = 0.0;  ///< of the oil on the piston, positive toward +x
    double end_stop_force_N = 0.0;  ///< on the piston, positive toward +x
  };
  /// What the sensors read.
  struct Reading {
    double position_m = 0.0;
    double pressure_force_N = 0.0;  ///< areas times measured pressures, positive toward +x
  };

  /// Fails where a value is out of bounds, where the parts contradict one another, or where the step is too long.
  static Result<ServoHydraulicSlave> make(const Params& params, Seconds dt);

  /// Advances by one substep under `current_mA`. Real-time safe.
  Output step(double current_mA) noexcept;
  /// What the sensors read now: draws samples of noise.
  Reading measure() noexcept;
  void reset() noexcept { reset(0.0); }
  /// At rest at `position_m`, the valve closed.
  void reset(double position_m) noexcept;
  [[nodiscard]] const HydraulicCylinder& cylinder() const noexcept { return cylinder_; }

 private:
  ServoHydraulicSlave(const Params& params, const ServoValve& valve, const HydraulicCylinder& cylinder,
                      const PressureSensor& first, const PressureSensor& second, const PositionTransducer& position)
      : first_area_m2_(params.cylinder.first_area_m2),
        second_area_m2_(params.cylinder.second_area_m2),
        valve_(valve),
        cylinder_(cylinder),
        first_pressure_(first),
        second_pressure_(second),
        position_(position) {
    reset();
  }

  double first_area_m2_, second_area_m2_;
  ServoValve valve_;
  HydraulicCylinder cylinder_;
  PressureSensor first_pressure_, second_pressure_;
  PositionTransducer position_;
};

}  // namespace tactus::mechanics
