// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/lane.hpp>
#include <tactus/kernel/mechanics/cable_driven_master.hpp>
#include <tactus/kernel/mechanics/operator.hpp>

#include <array>
#include <cmath>
#include <functional>

#include <bench/lane_peer.hpp>
#include <benchmark/benchmark.h>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

namespace tactus::bench {

namespace {

using Eight = stability::Lane<double, masters_at_once>;
using State = std::array<Eight, 6>;

constexpr double push_N = 0.5, tick_s = 200e-6;
constexpr int ticks = 200;

/// As one would write it for odeint, apart from the code of tactus.
struct HeldMaster {
  double step_s;
  bool smooth;
  double force_N;

  Eight rub(Eight force, Eight velocity, double mass_kg, double most_N) const {
    if (smooth) return force - most_N * velocity / (fabs(velocity) + 1e-3);
    return force - min(max(force + (mass_kg / step_s) * velocity, Eight(-most_N)), Eight(most_N));
  }
  void operator()(const State& x, State& rate, double) const {
    constexpr double motor_kg = 0.0075, drum_kg = 0.01075, handle_kg = 0.014;
    const Eight cable = 39500.0 * (x[0] - x[1]) + 3.6 * (x[3] - x[4]);
    const Eight linkage = 3950.0 * (x[1] - x[2]) + 0.02 * (x[4] - x[5]);
    rate[0] = x[3];
    rate[1] = x[4];
    rate[2] = x[5];
    rate[3] = (1.0 / motor_kg) * rub(force_N - cable, x[3], motor_kg, 0.01);
    rate[4] = (1.0 / drum_kg) * rub(cable - linkage, x[4], drum_kg, 0.0144);
    rate[5] = (1.0 / handle_kg) * (linkage - 40.0 * x[2] - 23.0 * x[5]);
  }
};

template <class Stepper>
std::vector<double> run_peer(double step_s, bool smooth) {
  Stepper stepper;
  HeldMaster master{step_s, smooth, push_N};
  State state{};
  for (Eight& number : state) number = 0.0;
  const int steps = static_cast<int>(std::lround(tick_s / step_s));
  std::vector<double> motor_m;
  for (int tick = 0; tick < ticks; ++tick) {
    master.force_N = tick < ticks / 2 ? push_N : 0.0;
    for (int i = 0; i < steps; ++i) stepper.do_step(std::ref(master), state, 0.0, step_s);
    motor_m.push_back(state[0].get(0));
  }
  return motor_m;
}

std::vector<double> run_tactus(double step_s) {
  mechanics::CableChain::Params params;
  params.linkage.hysteretic_fraction = 0.0;
  const auto chain = *mechanics::CableChain::make(params, mechanics::Operator::Params{}.grip, Seconds{step_s});
  mechanics::CableChainMotion<Eight> motion;
  constexpr std::size_t numbers = sizeof(motion) / sizeof(Eight);
  static_assert(sizeof(chain.motion()) == numbers * sizeof(double));
  const auto& from = reinterpret_cast<const std::array<double, numbers>&>(chain.motion());
  auto& to = reinterpret_cast<std::array<Eight, numbers>&>(motion);
  for (std::size_t n = 0; n < numbers; ++n) to[n] = Eight(from[n]);
  const int steps = static_cast<int>(std::lround(tick_s / step_s));
  std::vector<double> motor_m;
  for (int tick = 0; tick < ticks; ++tick) {
    const Eight force_N = tick < ticks / 2 ? push_N : 0.0;
    for (int i = 0; i < steps; ++i) {
      benchmark::DoNotOptimize(motion.advance(
          {.motor_force_N = force_N, .tip_force_N = 0.0, .grip_position_m = 0.0, .grip_velocity_m_per_s = 0.0},
          motion.step));
    }
    motor_m.push_back(motion.state.position_m[0].get(0));
  }
  return motor_m;
}

}  // namespace

bool has_avx512() { return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"); }

std::vector<double> run_masters(Method method, double step_s) {
  namespace odeint = boost::numeric::odeint;
  if (method == Method::euler) return run_peer<odeint::euler<State>>(step_s, false);
  if (method == Method::runge_kutta) return run_peer<odeint::runge_kutta4<State>>(step_s, true);
  return run_tactus(step_s);
}

double multiply_and_add(std::size_t rounds) {
  constexpr std::size_t chains = 16;
  __m512d sums[chains];
  for (std::size_t i = 0; i < chains; ++i) sums[i] = _mm512_set1_pd(static_cast<double>(i));
  const __m512d factor = _mm512_set1_pd(0.999999), more = _mm512_set1_pd(1e-3);
  for (std::size_t round = 0; round < rounds; ++round) {
#pragma GCC unroll 16
    for (std::size_t i = 0; i < chains; ++i) sums[i] = _mm512_fmadd_pd(sums[i], factor, more);
  }
  for (const __m512d& sum : sums) benchmark::DoNotOptimize(sum);
  return static_cast<double>(rounds * chains * masters_at_once * 2);
}

}  // namespace tactus::bench
