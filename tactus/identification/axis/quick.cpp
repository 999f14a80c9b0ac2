// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/excitation.hpp>
#include <tactus/identification/axis/quick.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

namespace tactus::identification {

namespace {

using enum BenchVariable;

/// Of the data sheet's parameters: what the motion above 15 Hz tells, from what tells most.
constexpr std::array of_chain{motor_mass,        motor_friction,   cable_stiffness,
                              cable_damping,     drum_mass,        drum_friction,
                              linkage_stiffness, linkage_damping,  linkage_hysteretic_fraction,
                              handle_mass,       operator_damping, linkage_slip_deflection,
                              amplifier_lag};
constexpr std::array of_hand{operator_stiffness, operator_correction, operator_reaction, operator_sight};
constexpr std::array of_amplifier{amplifier_gain, amplifier_offset};

constexpr double without_the_person_Hz = 15.0;

/// Half sines of 2 to 12 ms and up to the peak, either way, each with time to ring out.
std::vector<double> bursts_N(double peak_N, Seconds tick) {
  constexpr int bursts = 20;
  constexpr double apart_s = 0.25;
  const auto each = static_cast<std::size_t>(apart_s / tick.value);
  signal::Random draw(1);
  std::vector<double> force_N(each, 0.0);
  for (int burst = 0; burst < bursts; ++burst) {
    const double width_s = draw.uniform(0.002, 0.012);
    const double height_N = draw.uniform(0.2, 1.0) * (burst % 2 == 0 ? peak_N : -peak_N);
    for (std::size_t i = 0; i < each; ++i) {
      const double phase = static_cast<double>(i) * tick.value / width_s;
      force_N.push_back(phase < 1.0 ? height_N * std::sin(std::numbers::pi * phase) : 0.0);
    }
  }
  return force_N;
}

/// By how much white noise of the same weight in a fit would be off: the rms times the root of the correlation's length
/// in samples.
double equivalent_deviation(const std::vector<double>& residuals) {
  const auto covariance = [&residuals](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < residuals.size(); ++i) sum += residuals[i] * residuals[i - lag];
    return sum / static_cast<double>(residuals.size());
  };
  const double variance = covariance(0);
  double length = 1.0;
  const std::size_t longest = residuals.size() / 20;
  for (std::size_t lag = 1; lag < longest; ++lag) {
    const double now = covariance(lag) / variance;
    if (!(now > 0.0)) break;
    length += 2.0 * now;
  }
  return std::sqrt(variance * length);
}

class Quick {
 public:
  Quick(Rig& rig, const QuickParams& params, const IsolationProgress& progress)
      : rig_(rig), params_(params), progress_(progress), tick_(rig.tick_s()), knowledge_(params.data_sheet) {}

  Result<Isolation> run() {
    report("excite", 0.0);
    if (auto error = rig_.assemble(Assembly::held)) return *std::move(error);
    if (auto error = excite()) return *std::move(error);
    // The current monitor tells the gain; without one it stays with the data sheet.
    if (!fast_.front().run.current_force_N.empty()) {
      const auto left = knowledge_.fit(of_amplifier, std::span(fast_).subspan(1, 1), {.current_per_N = 1.0});
      if (!left) return left.error();
    }
    suppose();
    const State before = now();
    if (auto error = fit_rounds(Order::lower_first)) return *std::move(error);
    best_ = now();
    least_m2_ = left_m2(fast_);
    if (!knowledge_.found(cable_stiffness).determined) {
      // The cable's mode is misplaced: begin anew from where the highest sweep says it is.
      try_again(before, Order::lower_then_cable);
      for (const double aside : {1.0, 1.3, 1.0 / 1.3}) try_again(before, Order::whole, aside);
    }
    // What the data sheet calls impossible is misplaced too: begin anew with that back at the data sheet.
    State again = best_;
    if (set_back_impossible(again.knowledge)) try_again(again, Order::whole);
    go_to(best_);
    return result();
  }

 private:
  using Runs = std::vector<BenchExperiment>;

  /// What is known, with how much each run counts.
  struct State {
    BenchKnowledge knowledge;
    Runs fast, slow;
  };
  [[nodiscard]] State now() const { return {knowledge_, fast_, slow_}; }
  void go_to(const State& state) {
    knowledge_ = state.knowledge;
    fast_ = state.fast;
    slow_ = state.slow;
  }

  /// What a first round fits before the whole: the chain without the highest sweep, for where the cable's mode is still
  /// misplaced it would lead astray; then also the cable placed anew; or nothing.
  enum class Order { lower_first, lower_then_cable, whole };

  /// Chain and hand in turn, twice, the second time with runs weighed by what the first leaves.
  Check fit_rounds(Order order) {
    for (const int round : {0, 1}) {
      report("fit", 0.4 + 0.3 * round);
      if (order == Order::lower_first || (order == Order::lower_then_cable && round == 0)) {
        const auto lower = knowledge_.fit(of_chain, std::span(fast_).subspan(1), {.position_per_m = 1.0});
        if (!lower) return lower.error();
        if (order == Order::lower_then_cable) knowledge_.start_from(cable_stiffness, cable_of_the_mode());
      }
      const auto slow = knowledge_.fit(of_hand, slow_, {.position_per_m = 1.0});
      if (!slow) return slow.error();
      const auto whole = knowledge_.fit(of_chain, fast_, {.position_per_m = 1.0});
      if (!whole) return whole.error();
      weigh(fast_);
      weigh(slow_);
    }
    return {};
  }

  /// Fits anew from a state, with the cable at so many times what the highest sweep says, where that is given. What
  /// leaves least is kept; a fit that comes to nothing is no reason to give up.
  void try_again(const State& from, Order order, std::optional<double> aside = {}) {
    go_to(from);
    if (aside && order == Order::whole) knowledge_.start_from(cable_stiffness, *aside * cable_of_the_mode());
    if (fit_rounds(order)) return;
    const double left = left_m2(fast_);
    if (left >= least_m2_) return;
    least_m2_ = left;
    best_ = now();
  }

  /// Whether there was something to set back.
  static bool set_back_impossible(BenchKnowledge& knowledge) {
    constexpr double impossible = 4.0;
    bool any = false;
    for (const BenchVariable variable : of_chain) {
      if (knowledge.surprise(variable) < impossible) continue;
      knowledge.start_from_supposed(variable);
      any = true;
    }
    return any;
  }

  [[nodiscard]] double left_m2(std::span<const BenchExperiment> runs) const {
    double sum = 0.0;
    for (const BenchExperiment& one : runs) {
      for (const double left_m : knowledge_.left_m(one)) sum += left_m * left_m;
    }
    return sum;
  }

  /// The stiffness of the cable that leaves least of the highest sweep, all else as it is.
  [[nodiscard]] double cable_of_the_mode() const {
    constexpr double range = 2.5, step = 1.12;
    const double data_sheet = params_.data_sheet.master.cable.stiffness_N_per_m;
    BenchKnowledge moved = knowledge_;
    double best = data_sheet, least = std::numeric_limits<double>::infinity();
    for (double factor = 1.0 / range; factor < range; factor *= step) {
      moved.start_from(cable_stiffness, factor * data_sheet);
      double left = 0.0;
      for (const double left_m : moved.left_m(fast_.front())) left += left_m * left_m;
      if (left >= least) continue;
      least = left;
      best = factor * data_sheet;
    }
    return best;
  }

  void report(const std::string& what, double done) const {
    if (progress_) progress_(what, done);
  }

  /// The data sheet as it is known before.
  void suppose() {
    for (const BenchVariable variable : of_chain) {
      const bool of_person = variable == operator_damping;
      knowledge_.suppose(variable, (of_person ? 2.0 : 1.0) * params_.data_sheet_error);
    }
    for (const BenchVariable variable : of_hand) knowledge_.suppose(variable, 2.0 * params_.data_sheet_error);
  }

  Check perform(Runs& to, std::string title, std::vector<double> force_N, int steps_per_tick, double lower_Hz,
                double upper_Hz) {
    BenchExperiment experiment;
    experiment.title = std::move(title);
    experiment.assembly = Assembly::held;
    experiment.program.force_N = std::move(force_N);
    experiment.steps_per_tick = steps_per_tick;
    experiment.lower_Hz = lower_Hz;
    experiment.upper_Hz = upper_Hz;
    auto run = rig_.run(experiment.program);
    if (!run) return run.error();
    experiment.run = *std::move(run);
    to.push_back(std::move(experiment));
    return {};
  }

  Check sweep(Runs& to, double from_Hz, double to_Hz, double amplitude_N, double duration_s, SweepSpacing spacing,
              int steps_per_tick) {
    SweptSineParams sweep;
    sweep.start_Hz = from_Hz;
    sweep.end_Hz = to_Hz;
    sweep.duration_s = duration_s;
    sweep.amplitude_N = amplitude_N;
    sweep.spacing = spacing;
    sweep.envelope.force_limit_N = rig_.limits().force_N;
    auto force_N = swept_sine_N(sweep, tick_);
    if (!force_N) return force_N.error();
    return perform(
        to,
        "sweep " + format_number(from_Hz) + " to " + format_number(to_Hz) + " Hz, " + format_number(amplitude_N) + " N",
        *std::move(force_N), steps_per_tick, to_Hz, from_Hz);
  }

  Check excite() {
    constexpr double bursts_peak_N = 2.5;
    const double fast_s = params_.sweep_s;
    if (auto error = sweep(fast_, 700.0, 60.0, 3.0, fast_s, SweepSpacing::linear, 2)) return error;
    if (auto error = sweep(fast_, 150.0, 20.0, 1.5, fast_s, SweepSpacing::linear, 2)) return error;
    if (auto error = sweep(fast_, 120.0, 30.0, 0.4, fast_s, SweepSpacing::linear, 2)) return error;
    if (auto error = perform(fast_, "bursts of 2 to 12 ms", bursts_N(bursts_peak_N, tick_), 2, 0.0, 0.0)) return error;
    report("excite", 0.2);
    if (auto error = sweep(slow_, 20.0, 0.1, 2.0, params_.slow_sweep_s, SweepSpacing::logarithmic, 1)) return error;
    slow_.front().run = thinned(slow_.front().run, 4);
    constexpr double first_guess_fast_m = 3e-5, first_guess_slow_m = 2e-3;
    for (BenchExperiment& one : fast_) {
      one.high_pass_Hz = without_the_person_Hz;
      one.deviation_m = first_guess_fast_m;
    }
    slow_.front().deviation_m = first_guess_slow_m;
    return {};
  }

  void weigh(Runs& runs) const {
    for (BenchExperiment& one : runs) one.deviation_m = equivalent_deviation(knowledge_.left_m(one));
  }

  Result<Isolation> result() {
    Isolation isolation;
    for (std::size_t i = 0; i < bench_variables; ++i) {
      const auto variable = static_cast<BenchVariable>(i);
      if (!knowledge_.knows(variable) || variable == operator_sight) continue;
      isolation.parameters.push_back(knowledge_.found(variable));
    }
    isolation.correlation = knowledge_.correlation(isolation.parameters);
    isolation.found = knowledge_.params();
    for (auto* runs : {&fast_, &slow_}) {
      IsolationStage stage;
      stage.title = runs == &fast_ ? "held, above 15 Hz" : "held, slow";
      double squares_m2 = 0.0;
      std::size_t samples = 0;
      for (const BenchExperiment& one : *runs) {
        stage.modelled_m.push_back(replay(knowledge_, one));
        for (const double left_m : knowledge_.left_m(one)) squares_m2 += left_m * left_m;
        samples += one.run.position_m.size();
      }
      stage.residual_rms_m = std::sqrt(squares_m2 / static_cast<double>(samples));
      stage.experiments = std::move(*runs);
      isolation.stages.push_back(std::move(stage));
    }
    return isolation;
  }

  Rig& rig_;
  const QuickParams& params_;
  const IsolationProgress& progress_;
  Seconds tick_;
  BenchKnowledge knowledge_;
  Runs fast_, slow_;
  State best_{knowledge_, {}, {}};
  double least_m2_ = 0.0;
};

}  // namespace

Result<Isolation> identify_quickly(Rig& rig, const QuickParams& params, const IsolationProgress& progress) {
  return Quick(rig, params, progress).run();
}

}  // namespace tactus::identification
