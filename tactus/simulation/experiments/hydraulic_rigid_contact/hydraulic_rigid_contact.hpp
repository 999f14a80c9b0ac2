// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/mechanics/springs.hpp>
#include <tactus/simulation/teleoperator/hydraulic_rig.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// Sensorless teleoperation of the servo-hydraulic slave into its end stop (paper B, Fig. 8).
namespace tactus::experiments {

/// The word that selects the experiment in a file.
enum class HydraulicRigidContactKind { hydraulic_rigid_contact };
constexpr auto enumerators(HydraulicRigidContactKind) {
  return std::array{Enumerator{HydraulicRigidContactKind::hydraulic_rigid_contact, "hydraulic-rigid-contact"}};
}

struct HydraulicRigidContactTask {
  HydraulicRigidContactKind kind = HydraulicRigidContactKind::hydraulic_rigid_contact;
  double first_press_m = 0.015;
  double second_press_m = 0.03;
  double force_division = 100.0;
  std::int64_t blocks = 2;
  double delay_s = 0.0;
  double pressure_filter_Hz = 20.0;
  double training_amplitude_m = 0.05;
  static constexpr auto fields() {
    using P = HydraulicRigidContactTask;
    return List{field("kind", &P::kind, "Kind of the experiment."),
                field("first_press_m", &P::first_press_m, units::metre, between(1e-3, 0.1),
                      "Distance beyond the end stop to which the operator aims in the first press."),
                field("second_press_m", &P::second_press_m, units::metre, between(1e-3, 0.1),
                      "Distance beyond the end stop to which the operator aims in the second press."),
                field("force_division", &P::force_division, units::none, between(1.0, 1e5),
                      "Force at the slave divided by force at the master."),
                field("blocks", &P::blocks, between(1, 4), "Number of prediction blocks in the runs with prediction."),
                field("delay_s", &P::delay_s, units::second, between(0.0, 0.1), "Delay of the link in each direction."),
                field("pressure_filter_Hz", &P::pressure_filter_Hz, units::hertz, positive,
                      "Second-order low-pass on the force from the pressure sensors."),
                field("training_amplitude_m", &P::training_amplitude_m, units::metre, between(1e-4, 0.09),
                      "Sum of the amplitudes of the sines from which the model is identified.")};
  }
};

/// The operator's arm and the master that it moves: a mass on a spring and damper to where the operator means to be.
struct HydraulicMasterParams {
  double mass_kg = 1.0;
  mechanics::LinearSpring::Params hand{.stiffness_N_per_m = 800.0, .damping_N_s_per_m = 40.0};
  static constexpr auto fields() {
    using P = HydraulicMasterParams;
    return List{field("mass_kg", &P::mass_kg, units::kilogram, positive, "Mass of master and hand."),
                field("hand", &P::hand, "The operator's arm.")};
  }
};

struct HydraulicRigidContactParams : simulation::HydraulicRigParams {
  HydraulicRigidContactTask task;
  HydraulicMasterParams master;
  static constexpr auto fields() {
    return joined(List{field("task", &HydraulicRigidContactParams::task, "The motion and the loop."),
                       field("master", &HydraulicRigidContactParams::master, "The master.")},
                  simulation::HydraulicRigParams::fields());
  }
};

/// One press onto the end stop.
struct RigidContact {
  bool touched = false;
  bool settled = false;           ///< in its last 0.3 s the piston stays on the stop and the master within 0.1 mm RMS
  int touches = 0;                ///< how often the piston met the stop
  double fed_back_N = 0.0;        ///< mean at the end of the press, at the master, positive when it pushes back
  double ripple_N = 0.0;          ///< RMS about it
  double pressure_force_N = 0.0;  ///< from the sensors, mean at the end of the press
  double stop_force_N = 0.0;      ///< with which the piston truly presses the stop, the same
  double estimate_after_s = 0.0;  ///< from the first touch until the estimate reached half of its last value
  double pressure_after_s = 0.0;  ///< the same of the filtered pressure force
};

/// What happened with one estimator in the loop.
struct RigidContactRun {
  std::string name;
  std::int64_t blocks = 0;
  double time_constant_s = 0.0;
  double false_force_N = 0.0;  ///< RMS at the master before the first touch
  std::array<RigidContact, 2> contacts;
  std::vector<double> time_s, master_m, slave_m;
  std::vector<double> fed_back_N;        ///< at the master, positive when it pushes back
  std::vector<double> pressure_force_N;  ///< filtered, on the piston less what moves it at rest, divided alike
  std::vector<double> stop_force_N;      ///< true, positive when the piston presses, divided alike
};

/// What is wrong with the parameters, without running.
Check check(const HydraulicRigidContactParams& params);
/// Without prediction, then with it. Errors: those of rig, fit and estimator.
Result<std::vector<RigidContactRun>> run_hydraulic_rigid_contact(const HydraulicRigidContactParams& params);

}  // namespace tactus::experiments
