// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

/// What the lanes of maps are measured against: Boost.odeint on the same vectors of eight doubles, and the most that
/// the machine can multiply and add. Compiled for AVX-512, so only for a machine that has it.
namespace tactus::bench {

bool has_avx512();

/// Ways to simulate a held master (paper A, Table I, its linkage without hysteresis), eight at once.
enum class Method {
  tactus,  ///< `mechanics::CableChainMotion` on a lane type, Coulomb friction as an impulse
  euler,   ///< odeint, forward Euler, the friction force that brings to rest within the step: the same law in the limit
  runge_kutta,  ///< odeint, fourth order, with the friction f·v/(|v| + 1 mm/s), as it needs a smooth right side
};

/// The motor's position every 200 µs while 0.5 N push it for 20 ms and are gone for 20 ms. `step_s` divides 200 µs.
std::vector<double> run_masters(Method method, double step_s);
inline constexpr std::size_t masters_at_once = 8;
inline constexpr double run_length_s = 0.04;

/// A double multiplication and an addition, `rounds` times 16 chains of vectors of eight; returns how many
/// floating-point operations that were, a fused one counted twice.
double multiply_and_add(std::size_t rounds);

}  // namespace tactus::bench
