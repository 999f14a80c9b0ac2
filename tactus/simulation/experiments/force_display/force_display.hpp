// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/stages/cancellation.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/cable_driven_master.hpp>
#include <tactus/kernel/mechanics/operator.hpp>
#include <tactus/simulation/experiments/model_mismatch.hpp>
#include <tactus/simulation/teleoperator/clock.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// A force is played to a hand that moves the master, open loop (paper A, Figs. 4 and 12): how much of the motion that
/// it induces is left in the estimate of the intended motion?
namespace tactus::experiments {

/// The word that selects an experiment in a file.
enum class ForceDisplayKind { force_display };
constexpr auto enumerators(ForceDisplayKind) {
  return std::array{Enumerator{ForceDisplayKind::force_display, "force-display"}};
}

/// The force that is played: a decaying oscillation, or a piece of a recording.
struct ForceProfileParams {
  std::string file;
  std::string variable;
  std::int64_t column = 1;
  double sample_time_s = 0.0;
  double start_s = 0.0;
  double duration_s = 0.1;
  double scale_N = 0.0;
  double frequency_Hz = 110.0;
  double decay_time_s = 0.012;
  static constexpr auto fields() {
    return List{
        field("file", &ForceProfileParams::file,
              "Recording of the force: CSV with a header, or MATLAB v5. Empty: a synthetic transient. A relative path "
              "starts at the current folder."),
        field("variable", &ForceProfileParams::variable,
              "CSV: the column's name. MATLAB: the variable, such as scope.signals(2).values."),
        field("column", &ForceProfileParams::column, between(1, 1e6), "MATLAB: the column of the variable, from 1."),
        field("sample_time_s", &ForceProfileParams::sample_time_s, units::second, between(0.0, 1.0),
              "Time between samples; 0 takes it from the file."),
        field("start_s", &ForceProfileParams::start_s, units::second, between(0.0, 1e6),
              "Start of the part that is displayed, from the recording's first sample."),
        field("duration_s", &ForceProfileParams::duration_s, units::second, between(0.005, 10.0),
              "Length of the displayed part of the recording, or of the synthetic transient."),
        field("scale_N", &ForceProfileParams::scale_N, units::newton, between(-1e6, 1e6),
              "Newtons per unit of the recording; 0: the largest magnitude of the displayed part becomes the force "
              "limit."),
        field("frequency_Hz", &ForceProfileParams::frequency_Hz, units::hertz, between(1.0, 1000.0),
              "Synthetic transient: frequency."),
        field("decay_time_s", &ForceProfileParams::decay_time_s, units::second, between(1e-4, 1.0),
              "Synthetic transient: time in which it falls to 1/e.")};
  }
};

struct ForceDisplayTask {
  ForceDisplayKind kind = ForceDisplayKind::force_display;
  std::int64_t seed = 1;
  std::int64_t repeats = 8;
  double speed_m_per_s = 0.15;
  double observation_s = 0.1;
  double force_limit_N = 1.0;
  ModelMismatch mismatch{.mass = 1.2, .linkage_stiffness = 0.8, .operator_damping = 1.2};
  static constexpr auto fields() {
    return List{
        field("kind", &ForceDisplayTask::kind, "Kind of the experiment."),
        field("seed", &ForceDisplayTask::seed, non_negative, "Seed from which the tremor of each repeat is drawn."),
        field("repeats", &ForceDisplayTask::repeats, between(1, 10000), "Number of repeats of each case."),
        field("speed_m_per_s", &ForceDisplayTask::speed_m_per_s, units::metre_per_second, between(-1.0, 1.0),
              "Constant speed of the hand."),
        field("observation_s", &ForceDisplayTask::observation_s, units::second, between(0.02, 10.0),
              "Time for which the motion is analysed, from the start of the force."),
        field("force_limit_N", &ForceDisplayTask::force_limit_N, units::newton, positive_up_to(100.0),
              "Largest force; the profile is displayed at a quarter, at half and at all of it."),
        field("mismatch", &ForceDisplayTask::mismatch, "Errors of the mismatched model.")};
  }
};

/// What there is besides the displayed force and the hand: a master, and the controller's model of it.
struct ForceDisplayControl {
  control::ModelFidelity cancellation_model = control::ModelFidelity::sixth_order;
  control::CancellationStep cancellation_step = control::CancellationStep::exact;
  control::MasterModel model;
  static constexpr auto fields() {
    return List{field("cancellation_model", &ForceDisplayControl::cancellation_model,
                      "Masses, springs and friction of master and hand that the model contains."),
                field("cancellation_step", &ForceDisplayControl::cancellation_step, "Integration method of the model."),
                field("model", &ForceDisplayControl::model, "The controller's model of master and hand.")};
  }
};

struct ForceDisplayParams {
  mechanics::CableDrivenMaster::Params master;
  mechanics::Operator::Params person;
  simulation::ServoParams servo;
  simulation::PlantClockParams plant;
  ForceDisplayControl control;
  ForceProfileParams profile;
  ForceDisplayTask task;
  static constexpr auto fields() {
    return List{field("master", &ForceDisplayParams::master, "The master device."),
                field("operator", &ForceDisplayParams::person, "The operator at the master."),
                field("servo", &ForceDisplayParams::servo, "The servo clock."),
                field("plant", &ForceDisplayParams::plant, "The clock of the simulated plant."),
                field("control", &ForceDisplayParams::control, "The model under test."),
                field("profile", &ForceDisplayParams::profile, "The displayed force."),
                field("task", &ForceDisplayParams::task, "Display and analysis.")};
  }
};

/// One variant of the estimate at one scale.
struct ForceDisplayCase {
  double scale = 1.0;  ///< of the profile, full scale being the force limit
  control::ModelFriction friction = control::ModelFriction::total_velocity;
  bool mismatched = false;
  double induced_rms_m = 0.0;     ///< true induced motion of the motor above 20 Hz
  double kept_fraction = 0.0;     ///< what the estimate of the intended motion keeps of it, over the same
  double encoder_fraction = 0.0;  ///< the encoder's own error above 20 Hz, over the same
};

/// One playing for a picture, against time from the start of the force.
struct ForceDisplayTrace {
  double scale = 1.0;
  std::vector<double> time_s;
  std::vector<double> force_N;
  std::vector<double> measured_m;  ///< motor position
  std::vector<double> estimate_m;  ///< measured less induced, nominal model, friction on total velocity
  std::vector<double> without_m;   ///< true motor position of the same hand without the force
};

/// The experiment with its profile loaded and everything checked.
class ForceDisplay {
 public:
  static Result<ForceDisplay> make(const ForceDisplayParams& params);

  /// All cases: three scales, both frictions, nominal and mismatched model. RMS values are over all repeats.
  [[nodiscard]] std::vector<ForceDisplayCase> cases() const;
  /// The first repeat at each scale.
  [[nodiscard]] std::vector<ForceDisplayTrace> traces() const;

  /// The scales that are played.
  static constexpr std::array<double, 3> scales{0.25, 0.5, 1.0};

 private:
  ForceDisplay(const ForceDisplayParams& params, const simulation::Clock& clock, std::vector<double> profile_N)
      : params_(params), clock_(clock), profile_N_(std::move(profile_N)) {}

  struct Playing;
  [[nodiscard]] Playing play(double scale, std::int64_t repeat) const;

  ForceDisplayParams params_;
  simulation::Clock clock_;
  std::vector<double> profile_N_;  ///< at the servo rate, full scale
};

/// The profile of `params` in newtons at the servo rate, limited to full scale. Errors: those of `recording::read` and
/// `recording::resample`, with the key that caused them, and a piece outside the recording.
Result<std::vector<double>> load_profile(const ForceDisplayParams& params);

}  // namespace tactus::experiments
