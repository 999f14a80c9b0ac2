// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// A motion of all joints as a finite Fourier series that starts and ends at rest:
///
///     q(t) = centre + Σ_k  a_k sin(kωt) / (kω) − b_k cos(kωt) / (kω) ,   Σ_k a_k = 0 ,   Σ_k k·b_k = 0
///
/// so velocity and acceleration are zero at the start and after each period, and nothing has to be faded in. It starts
/// at `at(0)`, which is not the centre. Source: Swevers, Ganseman, Tükel, De Schutter, Van Brussel, Optimal robot
/// excitation and identification, IEEE Trans. Robotics and Automation 13(5), 1997; rest at the ends by the two sums.
class FourierMotion {
 public:
  struct State {
    arm::JointVector position, velocity, acceleration;
  };

  /// How many free numbers a joint has: its centre, and two for each harmonic but the first.
  static int coordinates(int harmonics) { return 2 * harmonics - 1; }

  /// `coordinates`: a row for each joint, `coordinates(harmonics)` columns, the centre first; 2 harmonics or more.
  FourierMotion(double period_s, int harmonics, Eigen::MatrixXd coordinates);

  [[nodiscard]] State at(double time_s) const;
  [[nodiscard]] double period_s() const { return period_s_; }
  [[nodiscard]] int joints() const { return static_cast<int>(coordinates_.rows()); }
  [[nodiscard]] const Eigen::MatrixXd& coordinates() const { return coordinates_; }
  /// The same about the same centres, `share` as large.
  [[nodiscard]] FourierMotion scaled(double share) const;

  /// Position, velocity and acceleration at a time for each coordinate: rows 0, 1 and 2.
  static Eigen::MatrixXd rows(double period_s, int harmonics, double time_s);

 private:
  double period_s_;
  int harmonics_;
  Eigen::MatrixXd coordinates_;
};

}  // namespace tactus::arm_identification
