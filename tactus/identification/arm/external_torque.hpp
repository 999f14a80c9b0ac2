// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/model.hpp>
#include <tactus/identification/arm/recording.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// The external torque of one joint in a contact: its mean, and how far the true one may be from that in 95 % of cases.
struct ArmContactTorque {
  std::string joint = {};
  double mean_N_m = 0.0;
  double within_N_m = 0.0;  ///< what the model leaves, and at a joint at rest what its friction may hide
};

/// A span of time in which something touched the arm.
struct ArmContact {
  double from_s = 0.0;  ///< on the clock of the recording
  double to_s = 0.0;
  std::vector<ArmContactTorque> joints = {};  ///< those whose external torque exceeds its threshold
};

/// How the model does on one joint where nothing touches the arm; efforts in the unit of the recording.
struct ArmJointResidual {
  std::string name = {};
  double effort_rms = 0.0;
  double residual_rms = 0.0;
  double relative = 0.0;
  double peak_external_N_m = 0.0;  ///< over the whole recording
};

/// External torque in an arm's joints, by row and joint.
struct ExternalTorque {
  std::vector<double> time_s = {};          ///< on the clock of the recording
  Eigen::MatrixXd torque_N_m = {};          ///< of the environment on the arm, positive toward +position
  std::vector<std::size_t> stretches = {};  ///< first row of each recording
  double left_out_s = 0.0;                  ///< of recordings that are too short
  std::vector<ArmJointResidual> joints = {};
  std::vector<ArmContact> contacts = {};
};

/// What pushes on the arm: the torque that its motion takes by the model less the one that its motors gave. Of
/// recordings that follow one another, as the stretches of a log.
///
/// Everything passes the model's zero-phase filter, so nothing lags; the first and last 1/cutoff of each recording are
/// left out, and so are recordings that are too short for the filter, if others are not. A contact is where the torque
/// of a joint exceeds its threshold for at least half a period of the cutoff; it begins and ends where the torque
/// passes half of the height that it has alongside, since the filter spreads an edge evenly. Contacts closer than a
/// period are one.
///
/// The threshold is the model's, `contact_threshold_N_m`, and of a joint at rest (slower than
/// `slowest_rad_per_s` for a period before and after) that plus its dry friction: at rest friction holds any torque up
/// to this, in either direction, and no motor shows it. So no arm needs to move, and one that holds still by its
/// friction is not taken for touched.
///
/// Errors: those of `ArmMotion::make`, but for joints that do not move. Not real-time safe.
Result<ExternalTorque> estimate_external_torque(const ArmModel& model, std::span<const ArmRecording> recordings);
Result<ExternalTorque> estimate_external_torque(const ArmModel& model, const ArmRecording& recording);

/// How often an arm that nothing touches is reported as touched, at most, in an hour of motion: what the model leaves
/// taken for Gaussian noise of its rms, evenly spread up to the cutoff, which then passes the thresholds of all joints
/// upward or downward so often (S. O. Rice, Mathematical analysis of random noise, Bell System Technical Journal 24,
/// 1945, eq. 3.3-11). Motion that the model was not identified with may leave more.
double false_contacts_per_hour(const ArmModel& model);

}  // namespace tactus::arm_identification
