// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>
#include <tactus/simulation/experiments/draws.hpp>
#include <tactus/simulation/experiments/force_display/force_display.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

namespace tactus::experiments {

namespace {

/// The hand moves this long before the force starts, so that everything runs steadily.
constexpr double approach_s = 0.3;
constexpr double displayed_cutoff_Hz = 20.0;

struct Variant {
  control::ModelFriction friction;
  bool mismatched;
};
constexpr std::array<Variant, 4> model_variants{{{control::ModelFriction::at_rest, false},
                                                 {control::ModelFriction::at_rest, true},
                                                 {control::ModelFriction::total_velocity, false},
                                                 {control::ModelFriction::total_velocity, true}}};
/// The variant that is shown in pictures.
constexpr std::size_t shown_variant = 2;

Result<control::Cancellation> make_variant(const ForceDisplayParams& params, const Variant& variant) {
  const control::MasterModel& nominal = params.control.model;
  return control::Cancellation::make(
      {.model = {.master = variant.mismatched ? mismatched(nominal, params.task.mismatch) : nominal,
                 .fidelity = params.control.cancellation_model,
                 .step = params.control.cancellation_step,
                 .friction = variant.friction}},
      Seconds{1.0 / params.servo.rate_Hz});
}

/// The error of a cancellation under the keys that this experiment has for its parameters.
Error key_of_display(Error error) {
  constexpr std::string_view master = "model.master.";
  if (error.parameter == "model.step") {
    error.parameter = "cancellation_step";
  } else if (error.parameter.starts_with(master)) {
    error.parameter = "model." + error.parameter.substr(master.size());
  }
  return error;
}

double square_sum(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return sum;
}

/// Sum of squares of `values` above 20 Hz.
double transient_energy(std::vector<double> values, double tick_s) {
  auto high_pass = signal::SecondOrderFilter::make(
      {.kind = signal::FilterKind::high_pass, .frequency_Hz = displayed_cutoff_Hz}, Seconds{tick_s});
  for (double& value : values) value = high_pass->step(value);
  return square_sum(values);
}

double difference_energy(const std::vector<double>& a, const std::vector<double>& b, double tick_s) {
  std::vector<double> difference(a.size());
  std::transform(a.begin(), a.end(), b.begin(), difference.begin(), std::minus<>());
  return transient_energy(std::move(difference), tick_s);
}

}  // namespace

/// One playing, tick by tick from the start of the force.
struct ForceDisplay::Playing {
  std::vector<double> force_N;
  std::vector<double> true_m;      ///< motor position
  std::vector<double> measured_m;  ///< the same through the encoder
  std::array<std::vector<double>, model_variants.size()> estimate_m;
};

Result<ForceDisplay> ForceDisplay::make(const ForceDisplayParams& params) {
  if (auto error = validate(params)) return *std::move(error);
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  for (const double factor : {1.0, params.person.grip_change.factor}) {
    const auto master = mechanics::CableDrivenMaster::make(params.master, mechanics::scaled(params.person.grip, factor),
                                                           Seconds{clock->substep_s});
    if (!master) {
      const Error& error = master.error();
      return under(error.parameter.starts_with("grip.") ? "operator" : "master", error);
    }
  }
  const auto person = mechanics::Operator::make(params.person, Seconds{clock->tick_s});
  if (!person) return under("operator", person.error());
  for (const Variant& variant : model_variants) {
    const auto cancellation = make_variant(params, variant);
    if (!cancellation) return under("control", key_of_display(cancellation.error()));
  }
  auto profile_N = load_profile(params);
  if (!profile_N) return profile_N.error();
  return ForceDisplay(params, *clock, *std::move(profile_N));
}

ForceDisplay::Playing ForceDisplay::play(double scale, std::int64_t repeat) const {
  mechanics::Operator::Params hand = params_.person;
  signal::Random draw =
      signal::Random(static_cast<std::uint64_t>(params_.task.seed)).fork(static_cast<std::uint64_t>(repeat));
  hand.tremor_frequency_Hz *= draw.uniform(0.8, 1.2);
  hand.tremor_phase_cycles = draw.uniform();
  limit_to_bounds(hand);
  // Where the force starts falls anywhere between two counts of the encoder.
  const double start_m =
      -params_.task.speed_m_per_s * approach_s + params_.master.encoder.resolution_m * draw.uniform();

  auto master = *mechanics::CableDrivenMaster::make(params_.master, hand.grip, Seconds{clock_.substep_s});
  auto person = *mechanics::Operator::make(hand, Seconds{clock_.tick_s});
  master.reset(start_m);
  std::vector<control::Cancellation> cancellations;
  for (const Variant& variant : model_variants) cancellations.push_back(*make_variant(params_, variant));

  Playing playing;
  const auto approach_ticks = static_cast<std::size_t>(std::lround(approach_s / clock_.tick_s));
  const auto ticks = approach_ticks + static_cast<std::size_t>(std::lround(params_.task.observation_s / clock_.tick_s));
  double command_N = 0.0;
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const auto path_at = [&](std::size_t t) {
      return start_m + params_.task.speed_m_per_s * static_cast<double>(t) * clock_.tick_s;
    };
    const bool playing_now = tick >= approach_ticks && tick - approach_ticks < profile_N_.size();
    const double force_N = playing_now ? scale * profile_N_[tick - approach_ticks] : 0.0;
    master.hold(mechanics::scaled(hand.grip, hand.grip_change.at(static_cast<double>(tick) * clock_.tick_s)));
    const double true_m = master.mechanism().motor_position_m();
    const double measured_m = master.measure().motor_position_m;
    for (std::size_t i = 0; i < model_variants.size(); ++i) {
      const double estimate_m = cancellations[i].step({.measured_position_m = measured_m, .motor_force_N = -force_N});
      if (tick >= approach_ticks) playing.estimate_m[i].push_back(estimate_m);
    }
    if (tick >= approach_ticks) {
      playing.force_N.push_back(force_N);
      playing.true_m.push_back(true_m);
      playing.measured_m.push_back(measured_m);
    }
    const auto aim = person.step({.path_m = path_at(tick),
                                  .path_at_next_tick_m = path_at(tick + 1),
                                  .handle_position_m = master.mechanism().tip_position_m()});
    for (int i = 0; i < clock_.substeps; ++i) {
      if (i == clock_.late_substeps) command_N = -force_N;
      master.step({.commanded_force_N = command_N,
                   .grip_position_m = aim.position_m + (i + 0.5) * clock_.substep_s * aim.velocity_m_per_s,
                   .grip_velocity_m_per_s = aim.velocity_m_per_s});
    }
  }
  return playing;
}

std::vector<ForceDisplayCase> ForceDisplay::cases() const {
  std::vector<ForceDisplayCase> all;
  for (const double scale : scales) {
    double induced = 0.0, encoder = 0.0;
    std::array<double, model_variants.size()> kept{};
    double ticks = 0.0;
    for (std::int64_t repeat = 0; repeat < params_.task.repeats; ++repeat) {
      const Playing with = play(scale, repeat);
      const Playing without = play(0.0, repeat);
      induced += difference_energy(with.true_m, without.true_m, clock_.tick_s);
      encoder += difference_energy(with.measured_m, with.true_m, clock_.tick_s);
      for (std::size_t i = 0; i < model_variants.size(); ++i) {
        kept[i] += difference_energy(with.estimate_m[i], without.true_m, clock_.tick_s);
      }
      ticks += static_cast<double>(with.true_m.size());
    }
    for (std::size_t i = 0; i < model_variants.size(); ++i) {
      all.push_back({.scale = scale,
                     .friction = model_variants[i].friction,
                     .mismatched = model_variants[i].mismatched,
                     .induced_rms_m = std::sqrt(induced / ticks),
                     .kept_fraction = std::sqrt(kept[i] / induced),
                     .encoder_fraction = std::sqrt(encoder / induced)});
    }
  }
  return all;
}

std::vector<ForceDisplayTrace> ForceDisplay::traces() const {
  const Playing without = play(0.0, 0);
  std::vector<ForceDisplayTrace> all;
  for (const double scale : scales) {
    Playing with = play(scale, 0);
    ForceDisplayTrace trace{.scale = scale,
                            .time_s = {},
                            .force_N = std::move(with.force_N),
                            .measured_m = std::move(with.measured_m),
                            .estimate_m = std::move(with.estimate_m[shown_variant]),
                            .without_m = without.true_m};
    for (std::size_t i = 0; i < trace.force_N.size(); ++i) {
      trace.time_s.push_back(static_cast<double>(i) * clock_.tick_s);
    }
    all.push_back(std::move(trace));
  }
  return all;
}

}  // namespace tactus::experiments
