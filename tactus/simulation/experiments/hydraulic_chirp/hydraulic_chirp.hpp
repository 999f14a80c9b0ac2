// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/teleoperator/hydraulic_rig.hpp>

#include <cstdint>
#include <string>
#include <vector>

/// The valve's current in free motion along a chirp, measured and as an inverse model states it (paper B, Fig. 7).
namespace tactus::experiments {

/// The word that selects the experiment in a file.
enum class HydraulicChirpKind { hydraulic_chirp };
constexpr auto enumerators(HydraulicChirpKind) {
  return std::array{Enumerator{HydraulicChirpKind::hydraulic_chirp, "hydraulic-chirp"}};
}

struct HydraulicChirpTask {
  HydraulicChirpKind kind = HydraulicChirpKind::hydraulic_chirp;
  double duration_s = 20.0;
  double start_frequency_Hz = 0.1;
  double end_frequency_Hz = 10.0;
  double amplitude_m = 0.02;
  double training_amplitude_m = 0.05;
  static constexpr auto fields() {
    using P = HydraulicChirpTask;
    return List{
        field("kind", &P::kind, "Kind of the experiment."),
        field("duration_s", &P::duration_s, units::second, between(2.0, 200.0), "Length of the chirp."),
        field("start_frequency_Hz", &P::start_frequency_Hz, units::hertz, between(0.01, 50.0),
              "First frequency of the chirp."),
        field("end_frequency_Hz", &P::end_frequency_Hz, units::hertz, between(0.01, 50.0),
              "Last frequency of the chirp."),
        field("amplitude_m", &P::amplitude_m, units::metre, between(1e-4, 0.09), "Amplitude of the desired position."),
        field("training_amplitude_m", &P::training_amplitude_m, units::metre, between(1e-4, 0.09),
              "Sum of the amplitudes of the sines from which the model is identified.")};
  }
};

struct HydraulicChirpParams : simulation::HydraulicRigParams {
  HydraulicChirpTask task;
  static constexpr auto fields() {
    return joined(List{field("task", &HydraulicChirpParams::task, "The motion.")},
                  simulation::HydraulicRigParams::fields());
  }
};

/// How well one estimator states the current. What the filters need to settle, 0.2 s, does not count.
struct CurrentScore {
  std::string name;
  std::int64_t blocks = 0;
  double time_constant_s = 0.0;
  double mae_mA = 0.0;              ///< mean absolute error along the chirp
  double mae_below_2_Hz_mA = 0.0;   ///< while the chirp is below 2 Hz; 0 where it never is
  std::vector<double> estimate_mA;  ///< along the chirp
};

struct HydraulicChirpResult {
  simulation::FittedInverseModel fitted;
  std::vector<simulation::HydraulicRig::Sample> run;
  std::vector<CurrentScore> scores;  ///< the one without prediction first
};

/// What is wrong with the parameters, without running.
Check check(const HydraulicChirpParams& params);
/// Identifies the model on one motion and judges it on the chirp: without prediction, with one, two and three blocks at
/// their best time constants on the training run, with two at the paper's 1.8 ms, and without prediction but with the
/// apparent mass of the fit. Errors: those of rig, fit and estimator.
Result<HydraulicChirpResult> run_hydraulic_chirp(const HydraulicChirpParams& params);

}  // namespace tactus::experiments
