// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/excitation.hpp>
#include <tactus/identification/axis/isolation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace tactus::identification {

namespace {

using enum BenchVariable;

/// Concatenates the parts of a program.
void append(std::vector<double>& to, const std::vector<double>& part) { to.insert(to.end(), part.begin(), part.end()); }

class Isolator {
 public:
  Isolator(Rig& rig, const IsolationParams& params, const IsolationProgress& progress)
      : rig_(rig), params_(params), progress_(progress), tick_(rig.tick_s()), knowledge_(params.start) {}

  Result<Isolation> run() {
    using Stage = Check (Isolator::*)();
    constexpr std::array<Stage, 6> stages{&Isolator::amplifier_and_motor,
                                          &Isolator::cable,
                                          &Isolator::drum,
                                          &Isolator::linkage,
                                          &Isolator::handle,
                                          &Isolator::held};
    for (const Stage next : stages) {
      if (auto error = (this->*next)()) return *std::move(error);
    }
    for (std::size_t i = 0; i < bench_variables; ++i) {
      // What the person's sight does beside being late, a fit needs and nobody else.
      if (static_cast<BenchVariable>(i) == operator_sight) continue;
      result_.parameters.push_back(knowledge_.found(static_cast<BenchVariable>(i)));
      if (static_cast<BenchVariable>(i) == linkage_damping) result_.parameters.push_back(knowledge_.loop_area());
    }
    result_.correlation = knowledge_.correlation(result_.parameters);
    result_.found = knowledge_.params();
    return std::move(result_);
  }

 private:
  using Programs = std::vector<BenchExperiment>;

  static BenchExperiment spring(double stiffness_N_per_m, double damping_N_s_per_m) {
    BenchExperiment experiment;
    experiment.program.stiffness_N_per_m = stiffness_N_per_m;
    experiment.program.damping_N_s_per_m = damping_N_s_per_m;
    return experiment;
  }

  Check add_sweep(Programs& to, BenchExperiment experiment, double from_Hz, double to_Hz, double amplitude_N,
                  SweepSpacing spacing, int steps_per_tick) {
    SweptSineParams sweep;
    sweep.start_Hz = from_Hz;
    sweep.end_Hz = to_Hz;
    sweep.duration_s = params_.sweep_s;
    sweep.amplitude_N = amplitude_N;
    sweep.spacing = spacing;
    sweep.envelope.force_limit_N = rig_.limits().force_N;
    auto force_N = swept_sine_N(sweep, tick_);
    if (!force_N) return force_N.error();
    experiment.program.force_N = *std::move(force_N);
    experiment.title =
        "sweep " + format_number(from_Hz) + " to " + format_number(to_Hz) + " Hz, " + format_number(amplitude_N) + " N";
    experiment.lower_Hz = std::min(from_Hz, to_Hz);
    experiment.upper_Hz = std::max(from_Hz, to_Hz);
    experiment.steps_per_tick = steps_per_tick;
    to.push_back(std::move(experiment));
    return {};
  }

  Check add_crossing(Programs& to, double stiffness_N_per_m, double damping_N_s_per_m) {
    CrossingParams crossing{.from_m = -0.015, .to_m = 0.015, .speed_m_per_s = 0.03};
    const auto there = crossing_m(crossing, tick_);
    if (!there) return there.error();
    BenchExperiment experiment = spring(stiffness_N_per_m, damping_N_s_per_m);
    // The run begins at 0, the crossing at its end: it is led there and back by a slow crossing of half the way.
    CrossingParams approach{.from_m = 0.0, .to_m = -0.015, .speed_m_per_s = 0.05};
    auto lead = crossing_m(approach, tick_);
    if (!lead) return lead.error();
    const std::size_t half = lead->size() / 2;
    auto& reference_m = experiment.program.reference_m;
    reference_m.assign(lead->begin(), lead->begin() + static_cast<std::ptrdiff_t>(half));
    append(reference_m, *there);
    reference_m.insert(reference_m.end(), lead->begin() + static_cast<std::ptrdiff_t>(half), lead->end());
    experiment.title = "crossing at 30 mm/s";
    to.push_back(std::move(experiment));
    return {};
  }

  Check perform(Assembly assembly, const std::string& title, Programs& programs) {
    if (progress_) progress_(title, done_);
    if (auto error = rig_.assemble(assembly)) return error;
    for (BenchExperiment& experiment : programs) {
      experiment.assembly = assembly;
      auto run = rig_.run(experiment.program);
      if (!run) return run.error();
      experiment.run = *std::move(run);
    }
    return {};
  }

  /// Finds what the data tell of `wanted`, and leaves the rest unknown where it is. A linkage whose loop tells no shape
  /// is taken for linear.
  Check fit(std::span<const BenchVariable> wanted, const Programs& experiments) {
    std::vector<BenchVariable> left(wanted.begin(), wanted.end());
    while (!left.empty()) {
      const auto residual = knowledge_.fit(left, experiments, {.position_per_m = 1.0});
      if (residual) return {};
      const auto untold = [&](BenchVariable variable) {
        return residual.error().parameter == BenchKnowledge::name(variable);
      };
      if (std::none_of(left.begin(), left.end(), untold)) return residual.error();
      if (untold(linkage_hysteretic_fraction) || untold(linkage_slip_deflection)) {
        knowledge_.assume_no_hysteresis();
        std::erase(left, linkage_hysteretic_fraction);
        std::erase(left, linkage_slip_deflection);
      } else {
        std::erase_if(left, untold);
      }
    }
    return {};
  }

  void keep(std::string title, Programs experiments, double done) {
    IsolationStage kept;
    kept.title = std::move(title);
    double squares_m2 = 0.0;
    std::size_t samples = 0;
    for (const BenchExperiment& experiment : experiments) {
      kept.modelled_m.push_back(replay(knowledge_, experiment));
      const std::vector<double>& modelled_m = kept.modelled_m.back();
      for (std::size_t i = 0; i < modelled_m.size(); ++i) {
        const double left_m = experiment.run.position_m[i] - modelled_m[i];
        squares_m2 += left_m * left_m;
      }
      samples += modelled_m.size();
    }
    kept.experiments = std::move(experiments);
    kept.residual_rms_m = std::sqrt(squares_m2 / static_cast<double>(samples));
    result_.stages.push_back(std::move(kept));
    done_ = done;
  }

  Check stage(const char* title, Assembly assembly, std::span<const BenchVariable> wanted, Programs programs,
              double done) {
    if (auto error = perform(assembly, title, programs)) return error;
    if (auto error = fit(wanted, programs)) return error;
    keep(title, std::move(programs), done);
    return {};
  }

  /// The current, read once a tick, tells gain and offset, and the bandwidth once it is known how late the force comes;
  /// that is what the motor's motion tells. So the two are fitted in turn.
  Check amplifier_and_motor() {
    BenchExperiment experiment = spring(300.0, 0.5);
    auto force_N =
        random_binary_N({.amplitude_N = 0.5, .hold_s = 4e-4, .duration_s = params_.sweep_s, .envelope = {}}, tick_);
    if (!force_N) return force_N.error();
    experiment.program.force_N = *std::move(force_N);
    experiment.title = "random binary force, 0.5 N";
    Programs of_amplifier{std::move(experiment)};
    if (auto error = perform(Assembly::motor, "amplifier", of_amplifier)) return error;
    Programs of_motor;
    if (auto error = add_crossing(of_motor, 300.0, 0.5)) return error;
    if (auto error = add_sweep(of_motor, spring(300.0, 0.5), 60.0, 8.0, 0.4, SweepSpacing::linear, 1)) return error;
    if (auto error = perform(Assembly::motor, "motor alone", of_motor)) return error;

    constexpr std::array of_current{amplifier_gain, amplifier_offset, amplifier_bandwidth};
    constexpr std::array of_motion{motor_mass, motor_friction, amplifier_lag};
    const auto fit_current = [&](std::span<const BenchVariable> wanted) -> Check {
      const auto left_N = knowledge_.fit(wanted, of_amplifier, {.current_per_N = 1.0});
      if (!left_N) return left_N.error();
      return {};
    };
    if (auto error = fit_current(std::span(of_current).first(2))) return error;
    if (auto error = fit(std::span(of_motion).first(2), of_motor)) return error;
    if (auto error = fit(of_motion, of_motor)) return error;
    // An amplifier too fast for its monitor keeps its bandwidth to itself; the motion needs no more than the lag.
    if (!fit_current(of_current)) {
      if (auto error = fit(of_motion, of_motor)) return error;
    }
    keep("amplifier", of_amplifier, 0.05);
    keep("motor alone", of_motor, 0.1);
    return {};
  }

  Check cable() {
    Programs programs;
    if (auto error = add_sweep(programs, {}, 700.0, 100.0, 3.0, SweepSpacing::linear, 4)) return error;
    return stage("cable, drum locked", Assembly::cable, std::array{cable_stiffness, cable_damping}, std::move(programs),
                 0.2);
  }

  Check drum() {
    Programs programs;
    if (auto error = add_crossing(programs, 600.0, 1.0)) return error;
    if (auto error = add_sweep(programs, spring(600.0, 1.0), 60.0, 8.0, 0.8, SweepSpacing::linear, 2)) return error;
    return stage("drum, linkage taken off", Assembly::drum, std::array{drum_mass, drum_friction}, std::move(programs),
                 0.3);
  }

  Result<Programs> loops(std::initializer_list<double> peaks_N) {
    BenchExperiment experiment;
    for (const double peak_N : peaks_N) {
      const auto loop = force_loops_N(
          {.peak_N = peak_N, .rate_N_per_s = 4.0, .loops = 1, .force_limit_N = rig_.limits().force_N}, tick_);
      if (!loop) return loop.error();
      append(experiment.program.force_N, *loop);
    }
    experiment.title = "slow force loops";
    return Programs{std::move(experiment)};
  }

  Check linkage() {
    const char* title = "linkage, handle locked";
    const auto& spring_now = knowledge_.params().master.linkage;
    const double reference_m = spring_now.reference_deflection_m;
    const double friction_N = knowledge_.params().master.motor.friction_N + knowledge_.params().master.drum.friction_N;
    const auto peak_N = [&] {
      return (knowledge_.params().master.linkage.stiffness_N_per_m * reference_m + friction_N) /
             knowledge_.params().amplifier_gain;
    };
    // A first loop, only to know which force deflects it as far as its stiffness is defined for.
    auto first = loops({peak_N()});
    if (!first) return first.error();
    if (auto error = perform(Assembly::linkage, title, *first)) return error;
    if (auto error = fit(std::array{linkage_stiffness}, *first)) return error;
    const double peak = peak_N();
    auto programs = loops({0.95 * peak, peak, 1.05 * peak, 0.97 * peak, 1.03 * peak});
    if (!programs) return programs.error();
    if (auto error = perform(Assembly::linkage, title, *programs)) return error;
    constexpr std::array shape{linkage_stiffness, linkage_hysteretic_fraction, linkage_slip_deflection};
    if (auto error = fit(shape, *programs)) return error;

    Programs sweeps;
    for (const double amplitude_N : {0.15, 0.3}) {
      if (auto error = add_sweep(sweeps, {}, 130.0, 30.0, amplitude_N, SweepSpacing::linear, 1)) return error;
    }
    if (auto error = perform(Assembly::linkage, title, sweeps)) return error;
    if (auto error = fit(std::array{linkage_damping}, sweeps)) return error;
    programs->insert(programs->end(), sweeps.begin(), sweeps.end());
    keep(title, *std::move(programs), 0.45);
    return {};
  }

  Check handle() {
    Programs programs;
    if (auto error = add_sweep(programs, spring(800.0, 1.5), 60.0, 5.0, 1.0, SweepSpacing::linear, 2)) return error;
    return stage("handle, held by nobody", Assembly::handle, std::array{handle_mass}, std::move(programs), 0.55);
  }

  Check held() {
    const char* title = "operator";
    SweptSineParams sweep;
    sweep.start_Hz = 20.0;
    sweep.end_Hz = 0.1;
    sweep.duration_s = params_.held_sweep_s;
    sweep.amplitude_N = 2.0;
    sweep.envelope.force_limit_N = rig_.limits().force_N;
    auto force_N = swept_sine_N(sweep, tick_);
    if (!force_N) return force_N.error();
    BenchExperiment experiment;
    experiment.title = "sweep 20 to 0.1 Hz, 2 N";
    experiment.lower_Hz = 0.1;
    experiment.upper_Hz = 20.0;
    experiment.program.force_N = *std::move(force_N);
    Programs programs{std::move(experiment)};
    if (auto error = perform(Assembly::held, title, programs)) return error;
    programs.front().run = thinned(programs.front().run, 4);
    constexpr std::array hand{operator_stiffness, operator_damping, operator_correction, operator_reaction,
                              operator_sight};
    // The sight alone last: far from the rest of the hand it would run off.
    if (auto error = fit(std::span(hand).first(4), programs)) return error;
    if (auto error = fit(hand, programs)) return error;
    keep(title, std::move(programs), 1.0);
    return {};
  }

  Rig& rig_;
  const IsolationParams& params_;
  const IsolationProgress& progress_;
  Seconds tick_;
  BenchKnowledge knowledge_;
  Isolation result_;
  double done_ = 0.0;
};

}  // namespace

Result<Isolation> isolate(Rig& rig, const IsolationParams& params, const IsolationProgress& progress) {
  return Isolator(rig, params, progress).run();
}

}  // namespace tactus::identification
