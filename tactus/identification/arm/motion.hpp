// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/recording.hpp>

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// Below this frequency arms move and their motors push; what is above is noise and the links' own ringing.
inline constexpr double default_arm_cutoff_Hz = 10.0;

/// A joint whose speed, as its root mean square, is below this contains no information about its inertia and
/// friction [rad/s].
inline constexpr double slowest_rad_per_s = 0.01;

/// A recording must last so long, in seconds, for motion below the cutoff.
constexpr double shortest_motion_s(double cutoff_Hz) { return 10.0 / cutoff_Hz; }

/// Which joints of a recording must move: all, as to identify them, or none, as to apply a model.
enum class JointsThatMove { all, any };

/// How an arm moved in a recording, thinned out to rows: everything through the same zero-phase low-passes, so that
/// efforts that a law computes from the motion and efforts that were measured can be compared.
///
/// Positions, velocities, accelerations and efforts first pass a fast filter, at four times the cutoff. Laws of the
/// motion are evaluated on those, and their results are low-passed as the efforts are (parallel filtering): a law of
/// low-passed motion is not the low-passed law, for gravity, Coriolis torque and friction are not linear. Velocity and
/// acceleration are slopes of the positions; of the measured velocity where that has less than half of the noise of the
/// positions' slope, as on servos with coarse encoders. As far as the filter has to guess, 1/cutoff at either end,
/// there are no rows. Source of parallel filtering: Gautier, Dynamic identification of robots with power model,
/// IEEE Int. Conf. Robotics and Automation, 1997.
class ArmMotion {
 public:
  /// `rows_per_s`: at most as many, and at least 2 of them for each period of the cutoff.
  ///
  /// Errors: those of the filter; `inconsistent` for a recording shorter than ten periods of the cutoff, for a joint
  /// that hardly moves where all must, and for a velocity of a joint that moves that is not the slope of its position,
  /// stating which joint it fits. `joints` names joints in errors. Not real-time safe.
  static Result<ArmMotion> make(const ArmRecording& recording, double cutoff_Hz, double rows_per_s,
                                const std::vector<std::string>& joints, JointsThatMove moving = JointsThatMove::all);

  [[nodiscard]] Eigen::Index rows() const { return effort.rows(); }
  [[nodiscard]] int joints() const { return static_cast<int>(effort.cols()); }
  /// A law of the velocity, taken at every sample of the recording and then low-passed as the efforts are: friction
  /// turns round faster than the filter, and at the samples it is what the efforts have.
  [[nodiscard]] Eigen::VectorXd of_velocity(int joint, const std::function<double(double)>& law) const;
  /// Puts `columns` numbers that a law makes of positions, velocities and accelerations into `values`.
  using Law = std::function<void(const Eigen::VectorXd& position, const Eigen::VectorXd& velocity,
                                 const Eigen::VectorXd& acceleration, Eigen::Ref<Eigen::VectorXd> values)>;
  /// A law of the whole motion, low-passed as the efforts are: a row for each instant.
  [[nodiscard]] Eigen::MatrixXd of_motion(Eigen::Index columns, const Law& law) const;
  /// Root mean square of the velocity that `of_velocity` sees [rad/s].
  [[nodiscard]] double speed(int joint) const;

  // A row for each instant, a column for each joint.
  std::vector<double> time_s;  ///< since the first sample
  Eigen::MatrixXd velocity, acceleration, effort;

 private:
  /// Low-passed at the cutoff, and thinned to rows.
  [[nodiscard]] Eigen::VectorXd low_passed(std::span<const double> fast) const;

  Eigen::MatrixXd fast_position_, fast_velocity_, fast_acceleration_;  ///< a column for each joint
  std::vector<std::vector<double>> sampled_velocity_;                  ///< by joint, at every sample
  Seconds sample_time_{0.0};
  Seconds fast_step_{0.0};
  std::size_t fast_stride_ = 1;
  double cutoff_Hz_ = 0.0;
  double fast_cutoff_Hz_ = 0.0;
  std::size_t first_ = 0;
  std::size_t stride_ = 1;
  std::size_t count_ = 0;
};

}  // namespace tactus::arm_identification
