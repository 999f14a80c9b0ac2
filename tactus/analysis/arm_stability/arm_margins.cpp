// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/arm_margins.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

namespace tactus::arm_stability {
namespace {

using Complex = std::complex<double>;
using ComplexMatrix = Eigen::MatrixXcd;
using Vector = Eigen::VectorXd;
constexpr double pi = std::numbers::pi;

struct Slowest {
  Complex pole = 0.0;   ///< of those that are not left to the person
  Complex drift = 0.0;  ///< of those that are
};

Slowest slowest_poles(const ArmLoop& loop, double force_gain) {
  const double slow = 2.0 * pi * persons_Hz * loop.tick_s();
  Slowest found;
  for (const Complex pole : stability::poles({.a = loop.closed(force_gain), .b = {}, .c = {}, .d = {}})) {
    Complex& largest = std::abs(pole - 1.0) < slow ? found.drift : found.pole;
    if (std::abs(pole) > std::abs(largest)) largest = pole;
  }
  return found;
}

/// The mode of a pole: one step of inverse iteration from a start that has no structure.
Eigen::VectorXcd mode_of(const Eigen::MatrixXd& a, Complex pole) {
  const Eigen::Index n = a.rows();
  Eigen::MatrixXd start(n, 1);
  for (Eigen::Index i = 0; i < n; ++i) start(i, 0) = 1.0 + std::sin(1.0 + static_cast<double>(i));
  const Complex beside = pole * (1.0 + 1e-9);
  return stability::response(
      {.a = a, .b = start, .c = Eigen::MatrixXd::Identity(n, n), .d = Eigen::MatrixXd::Zero(n, 1)}, beside);
}

double largest_singular_value(const ComplexMatrix& m) {
  const ComplexMatrix square = m.adjoint() * m;
  const Eigen::Index n = square.rows();
  Eigen::MatrixXd real(2 * n, 2 * n);
  real << square.real(), -square.imag(), square.imag(), square.real();
  return std::sqrt(std::max(0.0, signal::symmetric_eigenvalues(real)[2 * n - 1]));
}

/// The least of the largest singular value that scaling of the channels comes to.
double scaled_singular_value(ComplexMatrix m) {
  constexpr int rounds = 8;
  for (int round = 0; round < rounds; ++round) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      const double own = std::norm(m(i, i));
      const double row = m.row(i).squaredNorm() - own, column = m.col(i).squaredNorm() - own;
      if (!(row > 0.0) || !(column > 0.0)) continue;
      const double factor = std::pow(column / row, 0.25);
      m.row(i) *= factor;
      m.col(i) /= factor;
    }
  }
  return largest_singular_value(m);
}

/// μ(S − I/2) at a frequency.
double peak_at(const ArmLoop& loop, double force_gain, double frequency_rad_per_s) {
  const ComplexMatrix passes = stability::response(loop.open(), std::polar(1.0, frequency_rad_per_s * loop.tick_s()));
  const auto n = passes.rows();
  const ComplexMatrix unit = ComplexMatrix::Identity(n, n);
  const ComplexMatrix sensitivity = signal::complex_solve(unit - force_gain * passes, unit);
  return scaled_singular_value(sensitivity - 0.5 * unit);
}

}  // namespace

ArmMode slowest_mode(const ArmLoop& loop, double force_gain) {
  ArmMode found;
  const Slowest poles = slowest_poles(loop, force_gain);
  found.pole = poles.pole;
  found.drift_per_s = poles.drift == 0.0 ? 0.0 : std::log(std::abs(poles.drift)) / loop.tick_s();
  found.frequency_Hz = std::fabs(std::arg(found.pole)) / (2.0 * pi * loop.tick_s());
  const Eigen::VectorXcd mode = mode_of(loop.closed(force_gain), found.pole);
  const Vector leader = loop.leader_velocity(mode).cwiseAbs2().cwiseProduct(Vector(loop.leader_inertia().diagonal()));
  const Vector follower =
      loop.follower_velocity(mode).cwiseAbs2().cwiseProduct(Vector(loop.follower_inertia().diagonal()));
  found.of_leader = leader.sum() > follower.sum();
  Eigen::Index joint = 0;
  (found.of_leader ? leader : follower).maxCoeff(&joint);
  found.joint = static_cast<int>(joint);
  found.share = std::max(leader.sum(), follower.sum()) / (leader.sum() + follower.sum());
  return found;
}

bool stable(const ArmLoop& loop, double force_gain) { return std::abs(slowest_poles(loop, force_gain).pole) < 1.0; }

experiments::GainLimit gain_limit(std::span<const ArmLoop> loops) {
  constexpr double resolution = 1.005;
  return experiments::find_gain_limit(
      lowest_arm_gain, highest_arm_gain,
      [&](double gain) {
        return std::all_of(loops.begin(), loops.end(), [&](const ArmLoop& loop) { return stable(loop, gain); });
      },
      resolution);
}

stability::DiskMargin disk_margin(const ArmLoop& loop, double force_gain) {
  if (!stable(loop, force_gain)) return {.alpha = 0.0};
  constexpr double lowest_Hz = 0.1;
  constexpr int steps = 150, rounds = 16;
  const double lowest = 2.0 * pi * lowest_Hz, highest = pi / loop.tick_s();
  const double ratio = std::pow(highest / lowest, 1.0 / steps);
  double worst = 0.0, at = lowest;
  for (int i = 0; i <= steps; ++i) {
    const double frequency = lowest * std::pow(ratio, i);
    const double peak = peak_at(loop, force_gain, frequency);
    if (peak > worst) worst = peak, at = frequency;
  }
  // Golden section about the highest point of the grid.
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double below = at / ratio, above = std::min(at * ratio, highest);
  for (int round = 0; round < rounds; ++round) {
    const double left = above - golden * (above - below), right = below + golden * (above - below);
    const double at_left = peak_at(loop, force_gain, left), at_right = peak_at(loop, force_gain, right);
    (at_left > at_right ? above : below) = at_left > at_right ? right : left;
    if (std::max(at_left, at_right) > worst)
      worst = std::max(at_left, at_right), at = at_left > at_right ? left : right;
  }
  return {.alpha = 1.0 / worst, .frequency_rad_per_s = at};
}

}  // namespace tactus::arm_stability
