// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/servo_hydraulic_slave.hpp>
#include <tactus/simulation/teleoperator/clock.hpp>

#include <cstdint>
#include <functional>
#include <vector>

/// Paper B's rig: a servo-hydraulic slave under position control, and the inverse model of it (Sec. 5).
namespace tactus::simulation {

/// What the inverse model is given; the rest of it is identified on a run of the rig.
struct ValveCurrentModelParams {
  double actuator_gain_N_per_mA = 1320.0;
  double mass_kg = 6.8;
  double force_filter_s = 0.003;
  double derivative_filter_s = 0.003;
  static constexpr auto fields() {
    using P = ValveCurrentModelParams;
    return List{field("actuator_gain_N_per_mA", &P::actuator_gain_N_per_mA, units::newton_per_milliampere, positive,
                      "K_a: the stall force divided by the current that opens the valve fully."),
                field("mass_kg", &P::mass_kg, units::kilogram, non_negative, "M_s: moving mass, as weighed."),
                field("force_filter_s", &P::force_filter_s, units::second, non_negative,
                      "T_f: time constant of the low-pass on command and force."),
                field("derivative_filter_s", &P::derivative_filter_s, units::second, non_negative,
                      "T_d: time constant of the low-pass on velocity.")};
  }
};

struct HydraulicRigParams {
  mechanics::ServoHydraulicSlave::Params slave;
  double controller_gain_mA_per_m = 300.0;
  ValveCurrentModelParams model;
  ServoParams servo{.rate_Hz = 1000.0, .computation_delay_s = 0.0005};
  PlantClockParams plant;
  static constexpr auto fields() {
    using P = HydraulicRigParams;
    return List{field("slave", &P::slave, "Valve, cylinder and sensors."),
                field("controller_gain_mA_per_m", &P::controller_gain_mA_per_m, units::milliampere_per_metre, positive,
                      "K_c: current for one metre of error; the current is limited to the rated current of the valve."),
                field("model", &P::model, "The inverse model."), field("servo", &P::servo, "The servo clock."),
                field("plant", &P::plant, "The clock of the simulated slave.")};
  }
};

/// The rig and its position controller in virtual time.
class HydraulicRig {
 public:
  /// Fails where a value is out of bounds or where slave or clock refuse.
  static Result<HydraulicRig> make(const HydraulicRigParams& params);

  /// What the servo sees at a tick. Forces are positive toward +x.
  struct Sample {
    double time_s = 0.0;
    double current_mA = 0.0;        ///< that has acted until this sample
    double position_m = 0.0;        ///< measured, from mid-stroke
    double pressure_force_N = 0.0;  ///< of the measured chamber pressures on the piston
    double end_stop_force_N = 0.0;  ///< true, on the piston
  };
  [[nodiscard]] Sample sample() noexcept;
  /// Advances to the next tick with the slave commanded to be at `wanted_m`, `measured` the sample of this tick.
  void advance(const Sample& measured, double wanted_m) noexcept;

  [[nodiscard]] double tick_s() const noexcept { return clock_.tick_s; }

 private:
  HydraulicRig(const HydraulicRigParams& params, const Clock& clock, const mechanics::ServoHydraulicSlave& slave)
      : gain_mA_per_m_(params.controller_gain_mA_per_m),
        limit_mA_(params.slave.valve.rated_current_mA),
        clock_(clock),
        slave_(slave) {}
  double gain_mA_per_m_, limit_mA_;
  Clock clock_;
  mechanics::ServoHydraulicSlave slave_;
  double current_mA_ = 0.0;
  double end_stop_force_N_ = 0.0;
  long tick_ = 0;
};

/// The rig along a path of the wanted position, from mid-stroke.
Result<std::vector<HydraulicRig::Sample>> follow(const HydraulicRigParams& params,
                                                 const std::function<double(double time_s)>& wanted_m,
                                                 double duration_s);

/// The inverse model fitted to a run.
struct FittedInverseModel {
  control::InverseModelEstimator::Params model;  ///< with the mass as weighed, and no blocks yet
  double apparent_mass_kg = 0.0;                 ///< what the acceleration's coefficient comes to
  double residual_rms_mA = 0.0;                  ///< of the fit
};

/// The inverse model in the paper's form, eq. 7 for the damping, fitted to a run in free motion.
///
/// Least squares of the current on σ(v / 1 mm/s) − ½, v, |v| v, acceleration and 1, all behind the same zero-phase
/// low-pass at 30 Hz. The acceleration takes up the lags of valve and sensors, so that they do not flatten the damping;
/// in the model is the mass as weighed, for the lags are prediction's to make up for. Errors: those of the fit;
/// `inconsistent` for a run from which no damping follows that grows with velocity.
Result<FittedInverseModel> fit_inverse_model(const ValveCurrentModelParams& params,
                                             const std::vector<HydraulicRig::Sample>& run);

/// What is known of the rig after a run to and fro: what it would take from a user.
class IdentifiedRig {
 public:
  /// Twenty seconds of eight sines of 0.13 to 7.9 Hz, at most `amplitude_m` together, and the fit to them. No
  /// experiment is judged on this motion. Errors: those of the rig and of the fit.
  static Result<IdentifiedRig> make(const HydraulicRigParams& params, double amplitude_m);

  [[nodiscard]] const FittedInverseModel& fitted() const noexcept { return fitted_; }
  /// The fitted model with prediction blocks, their time constant the one that leaves least of the training run.
  /// Without blocks the fitted model. Errors: those of `prediction_time_from_data`.
  [[nodiscard]] Result<control::InverseModelEstimator::Params> with_blocks(std::int64_t blocks) const;

 private:
  IdentifiedRig() = default;
  FittedInverseModel fitted_;
  double tick_s_ = 0.0;
  std::vector<double> current_mA_, position_m_;
};

}  // namespace tactus::simulation
