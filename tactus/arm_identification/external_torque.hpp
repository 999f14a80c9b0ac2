#pragma once

#include <tactus/arm_identification/model.hpp>
#include <tactus/arm_identification/recording.hpp>

#include <string>
#include <vector>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// A span of time in which something touched the arm.
struct ArmContact {
  double from_s = 0.0;  ///< on the clock of the recording
  double to_s = 0.0;
  std::vector<std::string> joints = {};  ///< those whose external torque exceeds its threshold
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
  std::vector<double> time_s = {};  ///< on the clock of the recording
  Eigen::MatrixXd torque_N_m = {};  ///< of the environment on the arm, positive toward +position
  std::vector<ArmJointResidual> joints = {};
  std::vector<ArmContact> contacts = {};
};

/// What pushes on the arm: the torque that its motion takes by the model less the one that its motors gave.
///
/// Everything passes the model's zero-phase filter, so nothing lags; the first and last 1/cutoff of the recording are
/// left out. A contact is where the torque of a joint exceeds its threshold for at least half a period of the cutoff;
/// it begins and ends where the torque passes half of the height that it has alongside, since the filter spreads an
/// edge evenly. Contacts closer than a period are one. Errors: those of `ArmMotion::make`. Not real-time safe.
Result<ExternalTorque> estimate_external_torque(const ArmModel& model, const ArmRecording& recording);

}  // namespace tactus::arm_identification
