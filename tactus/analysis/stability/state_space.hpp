// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <functional>

#include <Eigen/Core>

/// Linear systems in state space. Users of the installed package need Eigen for this header.
namespace tactus::stability {

/// q⁺ = A q + B u, y = C q + D u at the ticks of a clock; or q̇ = A q + B u in continuous time.
struct StateSpace {
  Eigen::MatrixXd a, b, c, d;

  [[nodiscard]] Eigen::Index states() const { return a.rows(); }
  [[nodiscard]] Eigen::Index inputs() const { return b.cols(); }
  [[nodiscard]] Eigen::Index outputs() const { return c.rows(); }
};

/// C (p − A)⁻¹ B + D: the response at p = e^{jωT} of a sampled system, at p = jω of a continuous one. `p` must be no
/// eigenvalue of A.
Eigen::MatrixXcd response(const StateSpace& system, std::complex<double> p);

/// One tick of a linear system: from its state and input to its next state and output, both of the right size already.
using Tick = std::function<void(const Eigen::VectorXd& state, const Eigen::VectorXd& input, Eigen::VectorXd& next,
                                Eigen::VectorXd& output)>;

/// The matrices of a system that is given by what it does in a tick: the columns are what it makes of unit states and
/// unit inputs. Exact for a linear tick.
StateSpace assemble(Eigen::Index states, Eigen::Index inputs, Eigen::Index outputs, const Tick& tick);

/// A continuous system, strictly proper, behind a zero-order hold and sampled every `tick_s`. The held input changes
/// `late_s` after the sample that decided on it, 0 ≤ `late_s` < `tick_s`: with a delay each input becomes a state more.
/// Exact: matrix exponentials of the two parts of the tick.
/// Source: Franklin, Powell, Workman, Digital Control of Dynamic Systems, section 4.3.4 (hold with delay).
StateSpace sampled(const StateSpace& continuous, double tick_s, double late_s);

/// One input and one output of a system.
StateSpace one_channel(const StateSpace& system, Eigen::Index input, Eigen::Index output);

/// Eigenvalues of A. Not real-time safe; the time it takes grows with the cube of the states.
Eigen::VectorXcd poles(const StateSpace& system);

}  // namespace tactus::stability
