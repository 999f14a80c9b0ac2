// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/narx_fit.hpp>
#include <tactus/kernel/control/estimators/disturbance_observer.hpp>
#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/control/estimators/kalman_force_estimator.hpp>
#include <tactus/kernel/control/estimators/momentum_observer.hpp>
#include <tactus/kernel/control/stages/servo_pd.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/electric_slave.hpp>
#include <tactus/simulation/teleoperator/clock.hpp>

#include <array>
#include <string>
#include <vector>

/// Estimators of the slave's contact force on the same data: what each makes of free motion and of a contact.
namespace tactus::experiments {

/// The word that selects an experiment in a file.
enum class ForceEstimatorsKind { force_estimators };
constexpr auto enumerators(ForceEstimatorsKind) {
  return std::array{Enumerator{ForceEstimatorsKind::force_estimators, "force-estimators"}};
}

/// The slave rests for half a second, goes to and fro before the wall, rests, presses onto the wall, holds, and goes
/// back.
struct ForceEstimatorsTask {
  ForceEstimatorsKind kind = ForceEstimatorsKind::force_estimators;
  double free_amplitude_m = 0.01;
  double free_frequency_Hz = 1.0;
  double press_depth_m = 0.01;
  static constexpr auto fields() {
    using Task = ForceEstimatorsTask;
    return List{field("kind", &Task::kind, "Kind of the experiment."),
                field("free_amplitude_m", &Task::free_amplitude_m, units::metre, between(1e-4, 0.5),
                      "Amplitude of the motion back and forth. The smallest distance of this motion from the wall has "
                      "the same value."),
                field("free_frequency_Hz", &Task::free_frequency_Hz, units::hertz, between(0.1, 20.0),
                      "Frequency of this motion."),
                field("press_depth_m", &Task::press_depth_m, units::metre, between(1e-4, 0.5),
                      "Depth beyond the wall's surface to which the slave is commanded.")};
  }
};

struct ForceEstimatorsParams {
  ForceEstimatorsTask task;
  mechanics::ElectricSlave::Params slave;
  mechanics::Environment::Params environment;
  control::ServoPd::Params controller;
  simulation::ServoParams servo;
  simulation::PlantClockParams plant;
  control::InverseModelEstimator::Params inverse_model;
  control::DisturbanceObserver::Params disturbance_observer;
  control::MomentumObserver::Params momentum_observer;
  control::KalmanForceEstimator::Params kalman;
  identification::NarxStructure narx;
  static constexpr auto fields() {
    using Params = ForceEstimatorsParams;
    return List{field("task", &Params::task, "The motion."),
                field("slave", &Params::slave, "The slave device."),
                field("environment", &Params::environment, "The wall in front of the slave."),
                field("controller", &Params::controller, "The slave's position controller."),
                field("servo", &Params::servo, "The servo clock."),
                field("plant", &Params::plant, "The clock of the simulated plant."),
                field("inverse_model", &Params::inverse_model,
                      "The inverse model. It runs without prediction and with each kind of prediction; "
                      "inverse_model.prediction.kind has no effect."),
                field("disturbance_observer", &Params::disturbance_observer, "The disturbance observer."),
                field("momentum_observer", &Params::momentum_observer, "The momentum observer."),
                field("kalman", &Params::kalman, "The Kalman filter."),
                field("narx", &Params::narx, "The NARX model, fitted to another free motion of the same slave.")};
  }
};

/// What the servo saw and what was true, one entry a tick.
struct SlaveRun {
  double tick_s = 0.0;
  std::vector<control::SlaveMotionSample> samples;  ///< the command is the one that acted until this sample
  std::vector<double> sensor_N;                     ///< force of the wall on the slave, as the sensor read it
  std::vector<double> true_N;                       ///< and as it was, mean over the tick that ends here
};

/// When what happens, in s from the start.
struct ForceEstimatorsPlan {
  double rest_s, free_until_s, press_s, hold_s, release_s, end_s;
};
ForceEstimatorsPlan plan_of(const ForceEstimatorsTask& task);

struct EstimatorScore {
  std::string name;
  double rest_noise_N = 0.0;     ///< RMS about the mean while nothing moves
  double free_residual_N = 0.0;  ///< RMS in free motion, where the force is 0
  double contact_error_N = 0.0;  ///< RMS of the difference to the true force from the press to the release
  double lead_s = 0.0;           ///< where the correlation with the true force is greatest, positive when ahead
  std::vector<double> estimate_N;
};

struct ForceEstimatorsResult {
  SlaveRun run;
  identification::NarxFit narx;        ///< from `drive_for_narx`
  std::vector<EstimatorScore> scores;  ///< the sensor first
};

/// What is wrong with the parameters, without running.
Check check(const ForceEstimatorsParams& params);

/// The closed loop of slave and wall. Errors: whatever slave, wall, controller or clock refuse, under their names.
Result<SlaveRun> drive_slave(const ForceEstimatorsParams& params);

/// Free motion to fit the NARX model to: three cosines at 0.7, 1.7 and 4.1 times the frequency of the task's, together
/// of its amplitude, for ten of its periods and at least 10 s. Errors: as those of `drive_slave`.
Result<SlaveRun> drive_for_narx(const ForceEstimatorsParams& params);

/// Everything: every estimator on the same samples. Errors: also those of the estimators' `make` and
/// of `fit_narx`.
Result<ForceEstimatorsResult> compare_force_estimators(const ForceEstimatorsParams& params);

}  // namespace tactus::experiments
