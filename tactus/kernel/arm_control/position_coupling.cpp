// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/position_coupling.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/matrix_functions.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

namespace tactus::arm_control {
namespace {

using Complex = std::complex<double>;
using ComplexMatrix = Eigen::MatrixXcd;
constexpr double pi = std::numbers::pi;

/// C⁻¹ L₂ C⁻¹ L₁ at frequencies.
class Loop {
 public:
  Loop(const CoupledArm& leader, const CoupledArm& follower, const PositionCoupling& coupling)
      : leader_(leader), follower_(follower), coupling_(coupling) {}

  [[nodiscard]] ComplexMatrix at(double w) const {
    const ComplexMatrix back = divided(follower_, w);
    return back * divided(leader_, w);
  }
  /// Sizes of its eigenvalues, the largest first: each is continuous in the frequency.
  [[nodiscard]] std::vector<double> sizes(double w) const {
    std::vector<double> found;
    for (const Complex& value : signal::complex_eigenvalues(at(w))) found.push_back(std::abs(value));
    std::sort(found.rbegin(), found.rend());
    return found;
  }

 private:
  [[nodiscard]] ComplexMatrix divided(const CoupledArm& arm, double w) const {
    const Complex s(0.0, w);
    ComplexMatrix own = (s * s * arm.inertia.cast<Complex>() + s * arm.damping.cast<Complex>()).eval();
    own += arm.stiffness.cast<Complex>();
    for (Eigen::Index i = 0; i < own.rows(); ++i) {
      own(i, i) += coupling_.stiffness[i] + s * coupling_.damping[i];
      own.row(i) /= coupling_.stiffness[i] + coupling_.velocity_share * s * coupling_.damping[i];
    }
    return own;
  }

  const CoupledArm& leader_;
  const CoupledArm& follower_;
  const PositionCoupling& coupling_;
};

/// The smallest delay that turns the phase of `value` back to 0 at this frequency.
double delay_of(Complex value, double w) {
  const double turn = -std::arg(value);
  return (turn > 0.0 ? turn : turn + 2.0 * pi) / (2.0 * w);
}

/// Where the eigenvalue of this rank has the size 1, between two frequencies that have it on two sides.
double crossing(const Loop& loop, std::size_t rank, double below, double above) {
  const bool grows = loop.sizes(above)[rank] > 1.0;
  for (int round = 0; round < 50; ++round) {
    const double middle = std::sqrt(below * above);
    ((loop.sizes(middle)[rank] > 1.0) == grows ? above : below) = middle;
  }
  return std::sqrt(below * above);
}

DelayLimit limit_at(const Loop& loop, const PositionCoupling& coupling, double w) {
  const auto [values, vectors] = signal::complex_eigen(loop.at(w));
  Eigen::Index nearest = 0;
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    if (std::fabs(std::abs(values[i]) - 1.0) < std::fabs(std::abs(values[nearest]) - 1.0)) nearest = i;
  }
  const Eigen::VectorXd moves = vectors.col(nearest).cwiseAbs2();
  Eigen::Index joint = 0;
  moves.cwiseProduct(coupling.stiffness).maxCoeff(&joint);
  return {.delay_s = delay_of(values[nearest], w), .frequency_Hz = w / (2.0 * pi), .joint = static_cast<int>(joint)};
}

}  // namespace

double growth_per_s(const CoupledArm& leader, const CoupledArm& follower, const PositionCoupling& coupling,
                    const JointVector& scale) {
  const Eigen::Index n = scale.size();
  const Eigen::MatrixXd pull = Eigen::VectorXd(coupling.stiffness).asDiagonal();
  const Eigen::MatrixXd drag = Eigen::VectorXd(coupling.damping).asDiagonal();
  const Eigen::VectorXd asked = coupling.velocity_share * coupling.damping;
  // Positions of both arms, then velocities.
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(4 * n, 4 * n);
  system.topRightCorner(2 * n, 2 * n).setIdentity();
  const auto put = [&](const CoupledArm& arm, Eigen::Index own, Eigen::Index other, const Eigen::VectorXd& heard) {
    const Eigen::MatrixXd inverse = signal::inverse(Eigen::MatrixXd(arm.inertia));
    const auto row = 2 * n + own;
    system.block(row, own, n, n) = -inverse * (Eigen::MatrixXd(arm.stiffness) + pull);
    system.block(row, other, n, n) = inverse * pull;
    system.block(row, 2 * n + own, n, n) = -inverse * (Eigen::MatrixXd(arm.damping) + drag);
    system.block(row, 2 * n + other, n, n) = inverse * Eigen::MatrixXd(asked.cwiseProduct(heard).asDiagonal());
  };
  put(leader, 0, n, Eigen::VectorXd(scale).cwiseInverse());
  put(follower, n, 0, Eigen::VectorXd(scale));
  // Row by row or column by column: the eigenvalues are the same.
  double fastest = -std::numeric_limits<double>::infinity();
  for (const Complex& value : signal::eigenvalues(std::span(system.data(), static_cast<std::size_t>(system.size())),
                                                  static_cast<std::size_t>(4 * n))) {
    fastest = std::max(fastest, value.real());
  }
  return fastest;
}

std::optional<DelayLimit> delay_limit(const CoupledArm& leader, const CoupledArm& follower,
                                      const PositionCoupling& coupling, double longest_s) {
  constexpr double lowest_Hz = 0.2, highest_Hz = 300.0;
  constexpr int steps = 400;
  const Loop loop(leader, follower, coupling);
  const auto frequency = [](int step) {
    return 2.0 * pi * lowest_Hz * std::pow(highest_Hz / lowest_Hz, static_cast<double>(step) / steps);
  };
  std::optional<DelayLimit> least;
  std::vector<double> before = loop.sizes(frequency(0));
  for (int step = 1; step <= steps; ++step) {
    const std::vector<double> sizes = loop.sizes(frequency(step));
    for (std::size_t rank = 0; rank < sizes.size(); ++rank) {
      if ((sizes[rank] > 1.0) == (before[rank] > 1.0)) continue;
      const DelayLimit found = limit_at(loop, coupling, crossing(loop, rank, frequency(step - 1), frequency(step)));
      if (found.delay_s <= longest_s && (!least || found.delay_s < least->delay_s)) least = found;
    }
    before = sizes;
  }
  return least;
}

std::optional<DelayLimit> delay_limit_of_joint(double stiffness, double damping, double inertia_kg_m2,
                                               double velocity_share) {
  const double left = 2.0 * stiffness * inertia_kg_m2 - (1.0 - velocity_share * velocity_share) * damping * damping;
  if (!(left > 0.0)) return std::nullopt;
  const double w = std::sqrt(left) / inertia_kg_m2;
  const Complex own(stiffness - inertia_kg_m2 * w * w, damping * w);
  const Complex other(stiffness, velocity_share * damping * w);
  const Complex ratio = own / other;
  return DelayLimit{.delay_s = delay_of(ratio * ratio, w), .frequency_Hz = w / (2.0 * pi), .joint = 0};
}

}  // namespace tactus::arm_control
