// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/minimise.hpp>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>
#include <vector>

namespace tactus::arm_identification {
namespace {

using Eigen::VectorXd;

constexpr std::size_t kept_steps = 12;
constexpr int most_halvings = 25;
constexpr double enough_descent = 1e-4;  ///< share of the slope's promise (Armijo)
constexpr double too_little = 1e-6;

struct Step {
  VectorXd moved, turned;  ///< of the point, and of the slope
};

/// The two loops of L-BFGS: minus the inverse curvature times the slope.
VectorXd direction_of(const std::deque<Step>& steps, const VectorXd& slope) {
  VectorXd direction = -slope;
  if (steps.empty()) return direction / std::max(1e-12, slope.norm());
  std::vector<double> shares(steps.size());
  for (std::size_t i = steps.size(); i-- > 0;) {
    shares[i] = steps[i].moved.dot(direction) / steps[i].moved.dot(steps[i].turned);
    direction -= shares[i] * steps[i].turned;
  }
  direction *= steps.back().moved.dot(steps.back().turned) / steps.back().turned.squaredNorm();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double back = steps[i].turned.dot(direction) / steps[i].moved.dot(steps[i].turned);
    direction += (shares[i] - back) * steps[i].moved;
  }
  return direction;
}

}  // namespace

VectorXd minimise(const SmoothCost& cost, VectorXd start, int most_steps) {
  VectorXd at = std::move(start);
  VectorXd slope(at.size());
  double value = cost(at, slope);
  std::deque<Step> steps;
  for (int step = 0; step < most_steps; ++step) {
    VectorXd direction = direction_of(steps, slope);
    double descent = direction.dot(slope);
    if (!(descent < 0.0)) {
      steps.clear();
      direction = direction_of(steps, slope);
      descent = direction.dot(slope);
    }
    double length = 1.0;
    VectorXd next_slope(at.size());
    for (int halving = 0; halving < most_halvings; ++halving, length *= 0.5) {
      const VectorXd next = at + length * direction;
      const double tried = cost(next, next_slope);
      if (!(std::isfinite(tried) && tried <= value + enough_descent * length * descent)) continue;
      Step made{next - at, next_slope - slope};
      if (made.moved.dot(made.turned) > 1e-12 * made.turned.squaredNorm()) steps.push_back(std::move(made));
      if (steps.size() > kept_steps) steps.pop_front();
      const double gained = value - tried;
      at = next;
      slope = next_slope;
      value = tried;
      if (gained < too_little * std::fabs(value)) return at;
      break;
    }
    if (next_slope != slope) return at;  // no step along this direction gains
  }
  return at;
}

}  // namespace tactus::arm_identification
