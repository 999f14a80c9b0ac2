#pragma once

#include <tactus/arm_identification/recording.hpp>

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// Below this frequency arms move and their motors push; what is above is noise and the links' own ringing.
inline constexpr double default_arm_cutoff_Hz = 10.0;

/// How an arm moved in a recording: everything through one zero-phase low-pass, so that nothing linear is biased, and
/// thinned out to rows.
///
/// Velocity and acceleration are slopes of the low-passed positions; of the low-passed measured velocity where that has
/// less than half of the noise of the positions' slope, as on servos with coarse encoders. As far as the filter has to
/// guess, 1/cutoff at either end, there are no rows.
class ArmMotion {
 public:
  /// `rows_per_s`: at most as many, and at least 2 of them for each period of the cutoff.
  ///
  /// Errors: those of the filter; `inconsistent` for a recording shorter than ten periods of the cutoff, for a joint
  /// that hardly moves, and for a velocity that is not the slope of its position, saying which it fits. `joints` names
  /// joints in errors. Not real-time safe.
  static Result<ArmMotion> make(const ArmRecording& recording, double cutoff_Hz, double rows_per_s,
                                const std::vector<std::string>& joints);

  [[nodiscard]] Eigen::Index rows() const { return position.rows(); }
  [[nodiscard]] int joints() const { return static_cast<int>(position.cols()); }
  /// A law of the velocity, low-passed as the efforts are: it sees velocities up to four times the cutoff, for friction
  /// turns round faster than the filter.
  [[nodiscard]] Eigen::VectorXd of_velocity(int joint, const std::function<double(double)>& law) const;
  /// Root mean square of the velocity that `of_velocity` sees [rad/s].
  [[nodiscard]] double speed(int joint) const;

  // A row for each instant, a column for each joint.
  std::vector<double> time_s;  ///< since the first sample
  Eigen::MatrixXd position, velocity, acceleration, effort;

 private:
  [[nodiscard]] Eigen::VectorXd thinned(const std::vector<double>& values) const;

  std::vector<std::vector<double>> fast_velocity_;
  Seconds fast_step_{0.0};
  double cutoff_Hz_ = 0.0;
  std::size_t first_ = 0;
  std::size_t stride_ = 1;
  std::size_t count_ = 0;
};

}  // namespace tactus::arm_identification
