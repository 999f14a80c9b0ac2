// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/runtime/ros2/bridge.hpp>
#include <tactus/runtime/ros2/remote_path.hpp>
#include <tactus/runtime/servo/end_request.hpp>
#include <tactus/runtime/servo/real_time_streams.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <cstdint>
#include <vector>

namespace tactus::real_time {

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

/// A teleoperator among ROS 2 nodes, of which one may be the hand: the step of a servo thread. It steps as often as its
/// time has passed, missed deadlines included, for as long as the taps take or until its end is asked for; then its
/// forces fall at the rate limits of the gates. Real-time safe.
class HandSession {
 public:
  /// Errors: those of the experiment.
  static Result<HandSession> make(const experiments::TappingParams& params);

  /// Its peers, where its ticks go, and who may end it; all of it outlives it. Before the first tick.
  void begin(ros2::Bridge& bridge, const runtime::RealTimeStreams& streams, const runtime::EndRequest& end);
  /// False once it is over.
  bool operator()(const station::Tick& tick) noexcept;

  [[nodiscard]] double time_s() const noexcept { return static_cast<double>(done_) * teleoperator_.tick_s(); }
  /// Ticks in which the wall was touched.
  [[nodiscard]] int contacts() const noexcept { return contacts_; }
  [[nodiscard]] double peak_force_N() const noexcept { return peak_force_N_; }
  /// A safety gate has closed, or a device has left its workspace of 1 m.
  [[nodiscard]] bool diverged() const noexcept { return diverged_; }
  /// Another program was the hand.
  [[nodiscard]] bool driven() const noexcept { return path_.driven(); }

 private:
  HandSession(simulation::Teleoperator teleoperator, const ros2::RemotePath& path, TapScript script,
              double slave_workspace_m);
  /// One tick; `share` as in `Teleoperator::step`.
  void advance(std::int64_t stamp_ns, double share) noexcept;

  simulation::Teleoperator teleoperator_;
  ros2::RemotePath path_;
  TapScript script_;
  double slave_workspace_m_;
  ros2::Bridge* bridge_ = nullptr;
  runtime::RealTimeStreams streams_;
  const runtime::EndRequest* end_ = nullptr;
  std::int64_t to_time_of_day_ns_ = 0;
  std::int64_t first_tick_ = -1;
  std::int64_t done_ = 0;  ///< ticks
  double path_m_;
  int contacts_ = 0;
  double peak_force_N_ = 0.0;
  bool diverged_ = false;
  double letting_go_s_ = 0.0;
};

}  // namespace tactus::real_time
