// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// The value at a point; puts the slope there into `slope`, which has the size of the point.
using SmoothCost = std::function<double(const Eigen::VectorXd& at, Eigen::VectorXd& slope)>;

/// Walks from `start` to a point where `cost` is lower, by limited-memory BFGS with a backtracking line search, until
/// `most_steps` or until a step gains less than 1e-6 of the value. A cost that is not finite counts as higher than any.
/// Deterministic; not real-time safe. Source: Nocedal and Wright, Numerical Optimization, 2006, algorithms 7.4 and 7.5.
Eigen::VectorXd minimise(const SmoothCost& cost, Eigen::VectorXd start, int most_steps);

}  // namespace tactus::arm_identification
