#pragma once

#include <tactus/cli/output_folder.hpp>
#include <tactus/core/result.hpp>
#include <tactus/experiments/experiment.hpp>
#include <tactus/experiments/tapping/tapping.hpp>
#include <tactus/mechanics/minimum_jerk.hpp>
#include <tactus/ros2/bridge.hpp>
#include <tactus/runtime/end_request.hpp>
#include <tactus/runtime/servo_thread.hpp>
#include <tactus/simulation/teleoperator.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace tactus::cli {

/// The taps of a `tapping` experiment one after another without a break, for a teleoperator that is not set back in
/// between: rest, reach, press for `observation_s`, return. All have the mean depth; the speeds go evenly from the
/// slowest to the fastest.
class TapScript {
 public:
  explicit TapScript(const experiments::TappingParams& params);
  [[nodiscard]] double duration_s() const { return duration_s_; }
  /// Where the hand is meant to be; before and after, where it begins.
  [[nodiscard]] double position_m(double time_s) const;

 private:
  struct Tap {
    mechanics::MinimumJerk reach;
    mechanics::MinimumJerk back;
  };
  std::vector<Tap> taps_;
  double duration_s_ = 0.0;
};

/// What ROS 2 nodes see of a tick. The motor is commanded the opposite of the displayed force.
ros2::Snapshot snapshot_of(const simulation::Teleoperator::Record& record, std::int64_t stamp_ns, bool healthy);

struct Ros2Options {
  std::string name_space = "tactus";
  runtime::ServoThreadParams servo = {};  ///< the rate is that of the experiment
  const runtime::EndRequest& end;         ///< that somebody may make while it runs
  std::uint64_t log_limit_bytes = 0;      ///< as in `LogWriter::create`
};

/// Runs the teleoperator of a `tapping` experiment among ROS 2 nodes, on a servo thread, for as long as the taps of
/// `TapScript` take or until its end is asked for; then its forces fall at the rate limits of the gates. Deadlines that
/// are missed are made up for, so that its time keeps to the real one. A log goes into the folder of `output`, if there
/// is one. Errors: those of the experiment's file, of the network and of the log; `failed` once a safety gate has
/// closed or the devices have left their workspace.
Result<experiments::Outcome> run_ros2_session(const experiments::Request& request, const Ros2Options& options,
                                              OutputFolder& output);

}  // namespace tactus::cli
