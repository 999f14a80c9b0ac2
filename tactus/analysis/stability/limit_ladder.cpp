// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/bonded_run.hpp>
#include <tactus/analysis/stability/limit_ladder.hpp>
#include <tactus/analysis/stability/margins.hpp>
#include <tactus/analysis/stability/uncertainty.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::stability {

namespace {

using experiments::TappingParams;

constexpr Eigen::Index most_states = 400;

/// One thing that is not linear, and where it stands in the parameters.
struct Stage {
  const char *key, *words;
  void (*copy)(TappingParams& to, const TappingParams& from);
};

void copy_force_limits(TappingParams& to, const TappingParams& from) {
  to.control.force_limit_N = from.control.force_limit_N;
  to.control.gate = from.control.gate;
  to.control.handle_gate = from.control.handle_gate;
  to.control.slave_gate = from.control.slave_gate;
  to.master.amplifier.limit_N = from.master.amplifier.limit_N;
  to.master.handle_actuator.limit_N = from.master.handle_actuator.limit_N;
  to.slave.amplifier.limit_N = from.slave.amplifier.limit_N;
  to.slave.force_sensor.limit_N = from.slave.force_sensor.limit_N;
}

void copy_person(TappingParams& to, const TappingParams& from) { to.person = from.person; }

void copy_friction(TappingParams& to, const TappingParams& from) {
  const auto copy = [](auto& into, const auto& of) {
    into.motor.friction_N = of.motor.friction_N;
    into.drum.friction_N = of.drum.friction_N;
  };
  copy(to.master.mechanism, from.master.mechanism);
  copy(to.slave.mechanism, from.slave.mechanism);
  copy(to.control.model, from.control.model);
}

void copy_hysteresis(TappingParams& to, const TappingParams& from) {
  to.master.mechanism.linkage = from.master.mechanism.linkage;
  to.slave.mechanism.linkage = from.slave.mechanism.linkage;
  to.control.model.linkage.hysteretic_fraction = from.control.model.linkage.hysteretic_fraction;
}

void copy_quintic(TappingParams& to, const TappingParams& from) {
  to.control.model.hand.quintic_stiffness_N_per_m5 = from.control.model.hand.quintic_stiffness_N_per_m5;
}

void copy_encoders(TappingParams& to, const TappingParams& from) {
  to.master.encoder = from.master.encoder;
  to.slave.encoder = from.slave.encoder;
}

void copy_noise(TappingParams& to, const TappingParams& from) {
  to.master.force_sensor = from.master.force_sensor;
  to.slave.force_sensor = from.slave.force_sensor;
  to.channel = from.channel;
}

constexpr Stage stages[] = {
    {"force_limits", "limits of force", copy_force_limits},
    {"operator", "the operator's slow correction and tremor", copy_person},
    {"friction", "friction", copy_friction},
    {"hysteresis", "hysteresis of the linkages", copy_hysteresis},
    {"quintic_hand", "the quintic hand of the model", copy_quintic},
    {"encoders", "steps of the encoders", copy_encoders},
    {"noise", "noise of sensors, jitter and loss", copy_noise},
};

/// Taps on the wall of the file with everything else linear, and no force limited that a limit can be taken from.
TappingParams linear_taps(const TappingParams& file) {
  TappingParams params = file;
  static_cast<simulation::Teleoperator::Params&>(params) = linear_version(file);
  params.environment = file.environment;
  constexpr double most_N = 100.0, most_N_per_s = 1e6, no_limit_N = 1e6;
  params.control.force_limit_N = most_N;
  const auto widen = [](auto& gate) {
    gate.force_limit_N = most_N;
    gate.rate_limit_N_per_s = most_N_per_s;
  };
  widen(params.control.gate);
  widen(params.control.handle_gate);
  widen(params.control.slave_gate);
  params.master.amplifier.limit_N = no_limit_N;
  params.master.handle_actuator.limit_N = no_limit_N;
  params.slave.amplifier.limit_N = no_limit_N;
  params.slave.force_sensor.limit_N = no_limit_N;
  return params;
}

experiments::GainLimit tapped(TappingParams params) {
  return experiments::find_gain_limit(lowest_tried_gain, highest_tapped_gain, [&params](double gain) {
    params.control.force_gain = gain;
    return experiments::taps_settle(params);
  });
}

/// Whether every mode that the judge of taps looks at falls to a tenth in the time that it allows.
bool rings_out(const Loop& loop, double gain, double allowed_s) {
  constexpr double judged_from_Hz = 15.0;
  const double largest = std::pow(0.1, loop.tick_s / allowed_s);
  for (const std::complex<double> pole : poles(loop.closed(gain))) {
    const bool slow = std::fabs(std::arg(pole)) < turn * judged_from_Hz * loop.tick_s;
    // What falls slowly without swinging is no transient to the judge, unless it grows.
    if (std::abs(pole) > (slow ? 1.0 + 1e-7 : largest)) return false;
  }
  return true;
}

experiments::GainLimit as_searched(double gain) {
  return {.gain = std::min(gain, highest_linear_gain), .beyond_search = gain > highest_linear_gain};
}

}  // namespace

Result<std::vector<LimitRung>> limit_ladder(const TappingParams& params, const Linearisation& linearisation,
                                            const experiments::Progress& progress) {
  const auto loop = make_loop(params, linearisation);
  if (!loop) return loop.error();
  const TappingParams ideal = linear_taps(params);
  for (const TappingParams& taps : {params, ideal}) {
    if (const auto ensemble = experiments::TappingEnsemble::make(taps); !ensemble) return ensemble.error();
  }
  const simulation::Teleoperator::Params bonded = linear_version(params, linearisation.preload_N);
  if (const auto teleoperator = simulation::Teleoperator::make(bonded, 0.0); !teleoperator) return teleoperator.error();
  const auto wrong = uncertain_limit(params, linearisation, params.task.model_error);
  if (!wrong) return wrong.error();

  std::vector<LimitRung> rungs;
  rungs.push_back({.key = "linear",
                   .words = "linear loop, sampled",
                   .adds = "",
                   .limit = as_searched(gain_limit(*loop).force_gain)});
  rungs.push_back({.key = "bonded",
                   .words = "simulated in time, tip bonded",
                   .adds = "plants stepped, not solved",
                   .limit = bisect_linear_limit(bonded, lowest_tried_gain, highest_linear_gain)});
  Loop judged = *loop;
  if (params.control.cancellation == control::CancellationMode::on && params.task.model_error > 0.0) {
    rungs.push_back({.key = "wrong_models",
                     .words = "linear loop, worst model",
                     .adds = "a model that does not fit",
                     .limit = as_searched(wrong->smallest_limit)});
    simulation::Teleoperator::Params misjudged = params;
    misjudged.control.model = experiments::mismatched(params.control.model, wrong->worst);
    judged = *make_loop(misjudged, linearisation);
  }
  if (judged.master.states() + judged.slave.states() + judged.delay_ticks <= most_states) {
    const double allowed_s =
        experiments::settled_within_s + 2.0 * (params.channel.to_slave.delay_s + params.channel.to_master.delay_s);
    rungs.push_back({.key = "judged",
                     .words = "linear loop, criterion of taps",
                     .adds = "ringing must end in time",
                     .limit = experiments::find_gain_limit(lowest_tried_gain, highest_linear_gain, [&](double gain) {
                       return rings_out(judged, gain, allowed_s);
                     })});
  }
  const std::size_t first_tapped = rungs.size();
  rungs.push_back(
      {.key = "contact", .words = "taps, otherwise linear", .adds = "contact that is made and breaks", .limit = {}});
  std::vector<TappingParams> cases{ideal}, without;
  std::vector<std::size_t> without_rung;
  for (const Stage& stage : stages) {
    TappingParams next = cases.back();
    stage.copy(next, params);
    if (configuration::to_toml(next) == configuration::to_toml(cases.back())) continue;
    TappingParams lacking = params;
    stage.copy(lacking, ideal);
    cases.push_back(next);
    without.push_back(lacking);
    without_rung.push_back(rungs.size());
    rungs.push_back({.key = stage.key, .words = std::string("  and ") + stage.words, .adds = stage.words, .limit = {}});
  }
  simulation::for_each_in_parallel(
      cases.size() + without.size(),
      [&](std::size_t i) {
        if (i < cases.size()) {
          rungs[first_tapped + i].limit = tapped(cases[i]);
        } else {
          rungs[without_rung[i - cases.size()]].without = tapped(without[i - cases.size()]);
        }
      },
      progress);
  return rungs;
}

}  // namespace tactus::stability
