// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/state_space.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/matrix_functions.hpp>

#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/LU>

namespace tactus::stability {

Eigen::MatrixXcd response(const StateSpace& system, std::complex<double> p) {
  Eigen::MatrixXcd shifted = -system.a.cast<std::complex<double>>();
  shifted.diagonal().array() += p;
  return system.c * signal::complex_solve(shifted, system.b.cast<std::complex<double>>()) + system.d;
}

StateSpace assemble(Eigen::Index states, Eigen::Index inputs, Eigen::Index outputs, const Tick& tick) {
  StateSpace system{.a = Eigen::MatrixXd::Zero(states, states),
                    .b = Eigen::MatrixXd::Zero(states, inputs),
                    .c = Eigen::MatrixXd::Zero(outputs, states),
                    .d = Eigen::MatrixXd::Zero(outputs, inputs)};
  for (Eigen::Index i = 0; i < states + inputs; ++i) {
    Eigen::VectorXd state = Eigen::VectorXd::Zero(states), input = Eigen::VectorXd::Zero(inputs);
    Eigen::VectorXd next = Eigen::VectorXd::Zero(states), output = Eigen::VectorXd::Zero(outputs);
    (i < states ? state[i] : input[i - states]) = 1.0;
    tick(state, input, next, output);
    if (i < states) {
      system.a.col(i) = next;
      system.c.col(i) = output;
    } else {
      system.b.col(i - states) = next;
      system.d.col(i - states) = output;
    }
  }
  return system;
}

namespace {

/// Positions, velocities and forces differ by many orders of magnitude, which costs exponentials and eigenvalues their
/// digits. Scales each state by a power of two until rows and columns weigh alike (Parlett and Reinsch 1969): `a`
/// becomes D⁻¹ A D, with D, a diagonal, returned.
Eigen::VectorXd balance(Eigen::MatrixXd& a) {
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(a.rows());
  for (bool changed = true; changed;) {
    changed = false;
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      const double own = std::fabs(a(i, i));
      const double column = a.col(i).lpNorm<1>() - own, row = a.row(i).lpNorm<1>() - own;
      if (!(column > 0.0) || !(row > 0.0)) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (column * factor + row / factor >= 0.95 * (column + row)) continue;
      a.col(i) *= factor;
      a.row(i) /= factor;
      scale[i] *= factor;
      changed = true;
    }
  }
  return scale;
}

using RowByRow = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd exponential(RowByRow matrix) {
  signal::exponentiate({matrix.data(), static_cast<std::size_t>(matrix.size())},
                       static_cast<std::size_t>(matrix.rows()));
  return matrix;
}

/// What the state of `continuous` becomes after `time_s` under a held input: Φ and Γ side by side (Van Loan 1978).
Eigen::MatrixXd held(const StateSpace& continuous, double time_s) {
  const Eigen::Index n = continuous.states(), m = continuous.inputs();
  Eigen::MatrixXd augmented = Eigen::MatrixXd::Zero(n + m, n + m);
  augmented.topLeftCorner(n, n) = continuous.a * time_s;
  augmented.topRightCorner(n, m) = continuous.b * time_s;
  const Eigen::VectorXd scale = balance(augmented);
  return (scale.asDiagonal() * exponential(augmented) * scale.cwiseInverse().asDiagonal()).topRows(n);
}

}  // namespace

StateSpace sampled(const StateSpace& continuous, double tick_s, double late_s) {
  const Eigen::Index n = continuous.states(), m = continuous.inputs();
  const Eigen::MatrixXd early = held(continuous, late_s), rest = held(continuous, tick_s - late_s);
  const Eigen::MatrixXd phi = rest.leftCols(n) * early.leftCols(n);
  if (late_s == 0.0) return {.a = phi, .b = rest.rightCols(m), .c = continuous.c, .d = continuous.d};
  StateSpace system{.a = Eigen::MatrixXd::Zero(n + m, n + m),
                    .b = Eigen::MatrixXd::Zero(n + m, m),
                    .c = Eigen::MatrixXd::Zero(continuous.outputs(), n + m),
                    .d = continuous.d};
  system.a.topLeftCorner(n, n) = phi;
  system.a.topRightCorner(n, m) = rest.leftCols(n) * early.rightCols(m);
  system.b.topRows(n) = rest.rightCols(m);
  system.b.bottomRows(m).setIdentity();
  system.c.leftCols(n) = continuous.c;
  return system;
}

StateSpace one_channel(const StateSpace& system, Eigen::Index input, Eigen::Index output) {
  return {.a = system.a, .b = system.b.col(input), .c = system.c.row(output), .d = system.d.block(output, input, 1, 1)};
}

Eigen::VectorXcd poles(const StateSpace& system) {
  Eigen::MatrixXd balanced = system.a;
  balance(balanced);
  const RowByRow a = balanced;
  const auto values =
      signal::eigenvalues({a.data(), static_cast<std::size_t>(a.size())}, static_cast<std::size_t>(a.rows()));
  return Eigen::Map<const Eigen::VectorXcd>(values.data(), a.rows());
}

}  // namespace tactus::stability
