// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/cli/output_folder.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/end_request.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace tactus::cli {

struct Ros2Options {
  std::string name_space = "tactus";
  std::optional<std::string> live = {};   ///< as in `ObserverOptions`
  runtime::ServoThreadParams servo = {};  ///< the rate is that of the experiment
  const runtime::EndRequest& end;         ///< that somebody may make while it runs
  std::uint64_t log_limit_bytes = 0;      ///< as in `LogWriter::create`
};

/// Runs the teleoperator of a `tapping` experiment among ROS 2 nodes, on a servo thread, for as long as the taps of
/// `ros2::TapScript` take or until its end is asked for; then its forces fall at the rate limits of the gates.
/// Deadlines that are missed are made up for, so that its time keeps to the real one. A log goes into the folder of
/// `output`, if there is one. Errors: those of the experiment's file, of the network and of the log; `failed` once a
/// safety gate has closed or the devices have left their workspace.
Result<experiments::Outcome> run_ros2_session(const experiments::Request& request, const Ros2Options& options,
                                              OutputFolder& output);

}  // namespace tactus::cli
