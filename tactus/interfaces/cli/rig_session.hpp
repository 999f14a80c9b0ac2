// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig_second.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/rehearsal.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/joint_streams.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/runtime/servo/site_buttons.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::cli {

/// A pair of a rig that another program runs: it owns the screen and the operator's buttons, tactus owns the servo
/// thread. The pair is supervised as `tactus run --realtime --device RIG.toml` supervises it; both read the same files.
///
/// All functions may be called from any thread; they wait for one another, and never hold up the servo thread.
class RigSession {
 public:
  struct Settings {
    ExperimentOptions experiment;
    std::string rig;     ///< `FILE.toml` or `FILE.toml:PAIR`
    std::string folder;  ///< of the log; empty: none is written
    /// Emulated motors in place of those of the file, and timeouts for an ordinary computer. `led_reach_rad` 0: nobody
    /// moves an emulated leader arm.
    std::optional<Rehearsal> rehearsal;
    std::int64_t priority = 80;
  };

  /// What both sites did in one control cycle.
  struct Sample {
    std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC, deadline of the cycle; 0: there was none yet
    std::int64_t cycle = 0;    ///< its number, missed ones counted
    runtime::SiteTickRecord leader, follower;
    std::vector<runtime::JointLogRecord> leader_joints, follower_joints;
  };

  /// How the session went so far; `servo` is complete once it was stopped.
  struct Summary {
    devices::RigTotals totals;
    runtime::ServoReport servo;
    std::uint64_t log_dropped = 0;
  };

  /// Reads both files, asks all motors, and starts the servo thread. No motor has power until the word `arm`. Errors:
  /// those of the files, of the motors, and of the folder; all that is wrong with motors is in one message. Waits for
  /// the motors, some seconds.
  static Result<std::unique_ptr<RigSession>> start(const Settings& settings);
  RigSession(const RigSession&) = delete;
  RigSession& operator=(const RigSession&) = delete;
  /// Stops it.
  ~RigSession();

  [[nodiscard]] const std::vector<runtime::StreamedJoint>& joints() const noexcept;
  /// Whether the servo thread runs.
  [[nodiscard]] bool running() const;
  /// What the operator does. Errors: `failed` where sixteen words wait already, or it was stopped.
  Check press(std::string_view line);
  /// Of the newest control cycle.
  [[nodiscard]] Sample newest();
  /// One line: states, causes, what is wrong, what to do next; of the last whole second, with the reason of a driver
  /// that ended. Empty before the first second is over.
  [[nodiscard]] std::string line() const;
  [[nodiscard]] Summary summary() const;
  /// Forces fall to zero at the rate limits of their gates, the motors lose their power, and the log is closed. Waits
  /// for that, for a few seconds at most. Errors: `failed` for a motor that did not report that it is off; those of the
  /// log. A session that was stopped returns no error.
  Check stop();

 private:
  struct State;
  explicit RigSession(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tactus::cli
