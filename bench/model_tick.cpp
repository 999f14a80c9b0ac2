// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/stages/cancellation.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <bench/impact_forces.hpp>
#include <bench/peer_model.hpp>
#include <bench/sections.hpp>
#include <benchmark/benchmark.h>

namespace tactus::bench {

namespace {

using control::CancellationStep;
using control::InducedMotionModel;

constexpr int euler_substeps = 5;
constexpr const char* section = "One tick (200 us) of the model of induced motion";

/// Like the peer: with the paper's linear linkage, and friction on the induced velocity alone.
InducedMotionModel make_model(CancellationStep step) {
  InducedMotionModel::Params params;
  params.master.linkage.hysteretic_fraction = 0.0;
  params.step = step;
  params.friction = control::ModelFriction::at_rest;
  return *InducedMotionModel::make(params, Seconds{tick_s});
}

PeerModel make_peer(PeerModel::Friction friction) { return {friction, tick_s / euler_substeps}; }

/// A pass over all forces. Each tick starts from the state that the last one left, so this times dependent ticks.
template <class Model, class Tick>
void add_ticks(const char* name, Model model, Tick tick) {
  add_case(name, [model, tick, forces = impact_forces()]() mutable {
    for (const double force : forces) tick(model, force);
    benchmark::DoNotOptimize(model);
  });
}

/// Motor positions after each force.
template <class Model, class Tick>
std::vector<double> path_of(Model model, Tick tick) {
  std::vector<double> path_m;
  for (const double force : impact_forces()) {
    tick(model, force);
    path_m.push_back(model.motor_position_m());
  }
  return path_m;
}

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

void tick_model(InducedMotionModel& model, double force_N) { model.step({.motor_force_N = -force_N}); }
void tick_peer(PeerModel& peer, double force_N) { peer.advance(-force_N, euler_substeps); }

}  // namespace

void add_model_tick() {
  add_ticks("exact", make_model(CancellationStep::exact), tick_model);
  add_ticks("euler", make_model(CancellationStep::euler), tick_model);
  add_ticks("odeint projected", make_peer(PeerModel::Friction::projected), tick_peer);
  add_ticks("odeint tanh", make_peer(PeerModel::Friction::hyperbolic), tick_peer);

  add_ticks("hysteretic", *InducedMotionModel::make({}, Seconds{tick_s}), tick_model);
  const auto cancellation = *control::Cancellation::make({}, Seconds{tick_s});
  add_ticks("cancellation", cancellation, [](control::Cancellation& whole, double force_N) {
    const double measured_m = whole.model().motor_position_m();
    whole.step({.measured_position_m = measured_m, .motor_force_N = -force_N});
  });
  // Each result is the next sample, so that this is the latency of what stands between sample and command.
  add_case("after the sample", [cancellation, ticks = impact_forces().size()] {
    double position_m = 0.01;
    for (std::size_t i = 0; i < ticks; ++i) {
      benchmark::DoNotOptimize(position_m);
      position_m -= cancellation.model().motor_position_m();
    }
    benchmark::DoNotOptimize(position_m);
  });
}

Findings model_tick(const Times& times) {
  const auto tick_ns = [&times, ticks = static_cast<double>(impact_forces().size())](const char* name) {
    return 1e9 * times.at(name) / ticks;
  };

  constexpr int refinement = 256;
  const auto truth =
      path_of(PeerModel(PeerModel::Friction::projected, tick_s / (euler_substeps * refinement)),
              [](PeerModel& peer, double force_N) { peer.advance(-force_N, euler_substeps * refinement); });
  const auto error_m = [&truth](const std::vector<double>& path) { return rms_difference(path, truth); };
  const double exact_m = error_m(path_of(make_model(CancellationStep::exact), tick_model));
  const double euler_m = error_m(path_of(make_model(CancellationStep::euler), tick_model));
  const double peer_m = error_m(path_of(make_peer(PeerModel::Friction::projected), tick_peer));
  const double travel_m = rms_difference(truth, std::vector<double>(truth.size(), 0.0));

  using enum Finding::Goal;
  return {{section, "exact step", tick_ns("exact"), "ns"},
          {section, "Euler, 5 substeps", tick_ns("euler"), "ns"},
          {section, "exact step with a hysteretic linkage, the default", tick_ns("hysteretic"), "ns"},
          {section, "cancellation around that", tick_ns("cancellation"), "ns"},
          {section, "odeint Euler, 5 substeps, projected friction", tick_ns("odeint projected"), "ns"},
          {section, "odeint Euler, 5 substeps, tanh friction", tick_ns("odeint tanh"), "ns"},
          {section, "exact / odeint with projected friction", tick_ns("exact") / tick_ns("odeint projected"), "",
           at_most, 0.5},
          {section, "Euler / odeint with projected friction", tick_ns("euler") / tick_ns("odeint projected")},
          {section, "work after the sample arrives", tick_ns("after the sample"), "ns", at_most, 10.0},
          {section, "RMS error of the exact step, share of the motion", 100.0 * exact_m / travel_m, "%"},
          {section, "error of the exact step / of Euler", exact_m / euler_m, "", at_most, 0.4},
          {section, "error of the exact step / of odeint Euler", exact_m / peer_m, "", at_most, 0.4}};
}

}  // namespace tactus::bench
