// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/loop.hpp>

#include <complex>

/// The teleoperator as a two-port between hand and environment.
namespace tactus::stability {

/// The hybrid matrix at one frequency:  [F_h; −v_s] = H [v_m; F_s].
///
/// F_h, in N, is the force of the hand on the handle and v_m, in m/s, the handle's velocity, both positive toward the
/// environment; F_s is the force with which the environment pushes the tip back and v_s the tip's velocity. Ideal are
/// h11 = h22 = 0, h12 = 1, h21 = −1; with scales h12 = μ, h21 = −λ.
/// Source: Hannaford, A design framework for teleoperators with kinesthetic feedback, IEEE Trans. Robotics and
/// Automation 5(4), 1989; Lawrence 1993.
struct HybridMatrix {
  std::complex<double> h11, h12, h21, h22;
};

/// The two-port that `params` describe, nobody holding the handle and nothing before the tip. Exact for a sinusoidal
/// velocity and force up to the images that the holds make beyond half the sample rate, which are left out.
class TwoPort {
 public:
  /// Errors: those of `make_loop`. Not real-time safe.
  static Result<TwoPort> make(const simulation::Teleoperator::Params& params, const Linearisation& linearisation = {});

  /// H at an angular frequency in rad/s, above 0 and below π / tick.
  [[nodiscard]] HybridMatrix at(double frequency_rad_per_s) const;

 private:
  TwoPort() = default;
  double tick_s_ = 0.0, late_s_ = 0.0, force_gain_ = 0.0;
  Eigen::Index to_slave_ticks_ = 0, to_master_ticks_ = 0;
  LinearSites sites_;
  StateSpace master_, slave_, sampled_master_, sampled_slave_;
};

/// Llewellyn's index (2 Re h11 Re h22 − Re(h12 h21)) / |h12 h21|: with Re h11 ≥ 0 and Re h22 ≥ 0, at least 1 at every
/// frequency means stable between any two passive ends. −1 where one of the two real parts is negative.
/// Source: Llewellyn, Some fundamental properties of transmission systems, Proc. IRE 40, 1952.
double llewellyn_index(const HybridMatrix& h);

/// Largest singular value of the scattering matrix for waves of the impedance `reference_N_s_per_m`: at most 1 at every
/// frequency means passive, whatever the reference.
/// Source: Anderson and Spong, Bilateral control of teleoperators with time delay, IEEE Trans. Automatic Control 34(5),
/// 1989.
double scattering_norm(const HybridMatrix& h, double reference_N_s_per_m);

/// Smallest eigenvalue of the Hermitian part of H, in the same waves: at least 0 at every frequency means passive, and
/// how much damping at both ports a loop lacks or has to spare, in units of the reference impedance.
/// Source: Bao and Lee, Process Control: The Passive Systems Approach, 2007, section 2.3 (input feedforward passivity).
double passivity_index(const HybridMatrix& h, double reference_N_s_per_m);

/// What the hand feels, F_h / v_m in N s/m, with an environment of the impedance `environment_N_s_per_m` at the tip: 0
/// in free motion, b + k / (jω) on a wall.
std::complex<double> transmitted_impedance(const HybridMatrix& h, std::complex<double> environment_N_s_per_m);

}  // namespace tactus::stability
