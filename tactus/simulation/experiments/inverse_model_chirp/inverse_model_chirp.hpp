// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/simulation/teleoperator/delayed_slave.hpp>

#include <array>
#include <string>
#include <vector>

/// Force felt in free motion through an inverse model, with and without prediction (paper B, Fig. 5).
namespace tactus::experiments {

/// The word that selects the experiment in a file.
enum class InverseModelChirpKind { inverse_model_chirp };
constexpr auto enumerators(InverseModelChirpKind) {
  return std::array{Enumerator{InverseModelChirpKind::inverse_model_chirp, "inverse-model-chirp"}};
}

struct InverseModelChirpTask {
  InverseModelChirpKind kind = InverseModelChirpKind::inverse_model_chirp;
  double duration_s = 20.0;
  double start_frequency_Hz = 0.1;
  double end_frequency_Hz = 10.0;
  double amplitude_m = 0.1;
  double sample_rate_Hz = 5000.0;
  double fit_start_frequency_Hz = 30.0;
  static constexpr auto fields() {
    using P = InverseModelChirpTask;
    return List{
        field("kind", &P::kind, "Kind of the experiment."),
        field("duration_s", &P::duration_s, units::second, between(1.0, 200.0), "Length of each trajectory."),
        field("start_frequency_Hz", &P::start_frequency_Hz, units::hertz, between(0.01, 100.0),
              "First frequency of the trajectory chirp."),
        field("end_frequency_Hz", &P::end_frequency_Hz, units::hertz, between(0.01, 100.0),
              "Last frequency of the trajectory chirp."),
        field("amplitude_m", &P::amplitude_m, units::metre, positive_up_to(100.0), "Amplitude of the master's motion."),
        field("sample_rate_Hz", &P::sample_rate_Hz, units::hertz, between(500.0, 20000.0),
              "Sample rate of the estimators."),
        field("fit_start_frequency_Hz", &P::fit_start_frequency_Hz, units::hertz, between(1.0, 200.0),
              "Initial frequency of the poles of the fourth-order model that the experiment fits.")};
  }
};

struct InverseModelChirpParams {
  InverseModelChirpTask task;
  simulation::DelayedSlaveParams slave;
  control::InverseModelEstimator::Params estimator;
  static constexpr auto fields() {
    using P = InverseModelChirpParams;
    return List{field("task", &P::task, "Trajectories and sampling."),
                field("slave", &P::slave, "The simulated slave."),
                field("estimator", &P::estimator,
                      "Parameters of the inverse model. The experiment itself sets prediction.kind, prediction.blocks, "
                      "prediction.block.time_constant_s and declared_delay_s; values in the file have no effect.")};
  }
};

/// RMS of the force fed back in free motion, which should be 0.
struct FeltForce {
  double rms_N = 0.0;
  double below_2_Hz_N = 0.0;  ///< behind a fourth-order low-pass at 2 Hz (two Butterworth sections)
};

/// One estimator on the fitted trajectory and on the other.
struct InverseModelVariant {
  std::string name;
  int blocks = 0;
  double time_constant_s = 0.0;
  FeltForce chirp;
  FeltForce multisine;
  std::vector<double> felt_N;  ///< along the chirp
};

/// The data-driven time constant of two blocks on a chirp that ends at `band_Hz`.
struct BandOptimum {
  double band_Hz;
  double time_constant_s;
};

struct InverseModelChirpResult {
  double phase_margin_deg = 0.0;
  double closed_form_s = 0.0;  ///< of two blocks
  double limit_s = 0.0;
  std::vector<BandOptimum> by_band;
  double command_rms_N = 0.0;  ///< of the chirp, times the actuator's gain
  simulation::SlaveRecord chirp;
  std::vector<InverseModelVariant> variants;
};

/// The chirp from start to end frequency, its phase starting at 0.
simulation::Path chirp_path(const InverseModelChirpTask& task, double end_frequency_Hz);

/// The run on checked parameters. Errors: those of slave, estimator and fits.
Result<InverseModelChirpResult> run_inverse_model_chirp(const InverseModelChirpParams& params);
/// What is wrong with the parameters, without running.
Check check(const InverseModelChirpParams& params);

}  // namespace tactus::experiments
