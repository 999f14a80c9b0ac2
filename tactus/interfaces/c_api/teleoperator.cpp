// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/c_api/internal/errors.hpp>
#include <tactus/interfaces/c_api/internal/handles.hpp>
#include <tactus/interfaces/cli/rig_session.hpp>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace tactus::c_api {

namespace {

using cli::RigSession;
using control::SiteState;

static_assert(static_cast<int>(SiteState::configure) == TACTUS_SITE_CONFIGURE &&
              static_cast<int>(SiteState::align) == TACTUS_SITE_ALIGN &&
              static_cast<int>(SiteState::armed) == TACTUS_SITE_ARMED &&
              static_cast<int>(SiteState::active) == TACTUS_SITE_ACTIVE &&
              static_cast<int>(SiteState::hold) == TACTUS_SITE_HOLD &&
              static_cast<int>(SiteState::fault) == TACTUS_SITE_FAULT);

/// A session with the text that a view points at.
struct Running {
  std::unique_ptr<RigSession> session;
  std::string line = {};
  std::unique_ptr<std::atomic<bool>> stopped = std::make_unique<std::atomic<bool>>(false);
};

Handles<Running, teleoperator_kind>& teleoperators() {
  static auto* const all = new Handles<Running, teleoperator_kind>;
  return *all;
}

const char* text_of(std::int64_t cause) {
  for (const auto& [value, name] : enumerators(control::SiteCause{})) {
    if (static_cast<std::int64_t>(value) == cause) return name;
  }
  return "";
}

tactus_joint_sample sample_of(const runtime::JointLogRecord& joint, double external) {
  return {.position = joint.position_m,
          .velocity = joint.drive_velocity_m_per_s,
          .torque = joint.drive_force_N,
          .command = joint.motor_force_N,
          .external_torque = external};
}

RigSession::Settings settings_of(const tactus_teleoperator_options& options) {
  RigSession::Settings settings;
  settings.experiment.file = options.experiment;
  for (std::size_t i = 0; i < options.set_count; ++i) settings.experiment.set.emplace_back(options.set[i]);
  settings.rig = options.rig;
  if (options.log_folder != nullptr) settings.folder = options.log_folder;
  if (options.rehearsal != 0) {
    settings.rehearsal = {.faults = {}, .led_reach_rad = options.hand_reach_rad, .led_after_s = options.hand_after_s};
  }
  settings.priority = options.priority;
  return settings;
}

/// What of the hand is out of bounds.
Check check_hand(const tactus_teleoperator_options& options) {
  constexpr Bounds reaches = between(0.0, 3.0), times = between(0.0, 1e6);
  if (!reaches.contain(options.hand_reach_rad)) {
    return out_of_bounds("hand_reach_rad", options.hand_reach_rad, reaches, tactus::Unit{"rad", "_rad"});
  }
  if (!times.contain(options.hand_after_s)) {
    return out_of_bounds("hand_after_s", options.hand_after_s, times, units::second);
  }
  return std::nullopt;
}

}  // namespace

}  // namespace tactus::c_api

using namespace tactus::c_api;

tactus_status tactus_teleoperator_start(const tactus_teleoperator_options* options, tactus_teleoperator* made,
                                        tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    if (made == nullptr) return bad_argument("`made` is NULL: pass where the handle is to be left", error);
    *made = 0;
    if (!has_known_size(options)) {
      return bad_argument("`options` is NULL or of another size: begin with TACTUS_TELEOPERATOR_OPTIONS_INIT", error);
    }
    if (options->experiment == nullptr || options->rig == nullptr) {
      return bad_argument("`experiment` or `rig` is NULL: name both files", error);
    }
    for (std::size_t i = 0; i < options->set_count; ++i) {
      if (options->set == nullptr || options->set[i] == nullptr) {
        return bad_argument("`set` has fewer texts than `set_count`: pass as many", error);
      }
    }
    if (const auto wrong = check_hand(*options)) return leave(*wrong, error);
    auto session = tactus::cli::RigSession::start(settings_of(*options));
    if (!session) return leave(session.error(), error);
    *made = teleoperators().add({.session = *std::move(session)});
    if (*made != 0) return TACTUS_OK;
    return leave_text("there are 65536 teleoperators already: release those that are not used any more", TACTUS_FAILED,
                      error);
  });
}

tactus_status tactus_teleoperator_press(tactus_teleoperator teleoperator, const char* word, tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    if (word == nullptr) return bad_argument("`word` is NULL: pass for instance \"arm\"", error);
    const Running* const found = teleoperators().find(teleoperator);
    if (found == nullptr) {
      return leave_text("the handle is of no teleoperator, or it was released: start one", TACTUS_BAD_HANDLE, error);
    }
    const auto refused = found->session->press(word);
    return refused ? leave(*refused, error) : TACTUS_OK;
  });
}

tactus_status tactus_teleoperator_read(tactus_teleoperator teleoperator, tactus_teleoperator_view* view) {
  return guarded(nullptr, [&]() -> tactus_status {
    if (!has_known_size(view)) return TACTUS_BAD_ARGUMENT;
    Running* const found = teleoperators().find(teleoperator);
    if (found == nullptr) return TACTUS_BAD_HANDLE;
    const auto newest = found->session->newest();
    found->line = found->session->line();
    return fill(view, {.struct_size = 0,
                       .running = found->session->running() ? 1 : 0,
                       .leader_state = static_cast<tactus_site_state>(newest.leader.state),
                       .follower_state = static_cast<tactus_site_state>(newest.follower.state),
                       .reserved = 0,
                       .leader_cause = text_of(newest.leader.cause),
                       .follower_cause = text_of(newest.follower.cause),
                       .line = found->line.c_str(),
                       .joints = found->session->joints().size(),
                       .cycle = newest.cycle,
                       .time_ns = newest.time_ns});
  });
}

tactus_status tactus_teleoperator_joint(tactus_teleoperator teleoperator, size_t joint, const char** name,
                                        int32_t* turns) {
  const Running* const found = teleoperators().find(teleoperator);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  if (name == nullptr || turns == nullptr) return TACTUS_BAD_ARGUMENT;
  const auto& joints = found->session->joints();
  if (joint >= joints.size()) return TACTUS_OUT_OF_BOUNDS;
  *name = joints[joint].name.c_str();
  *turns = joints[joint].turns ? 1 : 0;
  return TACTUS_OK;
}

tactus_status tactus_teleoperator_newest(tactus_teleoperator teleoperator, size_t joints, tactus_joint_sample* leader,
                                         tactus_joint_sample* follower, int64_t* time_ns) {
  return guarded(nullptr, [&]() -> tactus_status {
    const Running* const found = teleoperators().find(teleoperator);
    if (found == nullptr) return TACTUS_BAD_HANDLE;
    if (leader == nullptr || follower == nullptr || time_ns == nullptr) return TACTUS_BAD_ARGUMENT;
    if (joints != found->session->joints().size()) return TACTUS_OUT_OF_BOUNDS;
    const auto newest = found->session->newest();
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const auto& of_leader = newest.leader_joints[joint];
      const auto& of_follower = newest.follower_joints[joint];
      using Record = tactus::runtime::JointLogRecord;
      leader[joint] = sample_of(of_leader, -static_cast<const Record::Received&>(of_leader).force_N);
      follower[joint] = sample_of(of_follower, -static_cast<const Record::Sent&>(of_follower).force_N);
    }
    *time_ns = newest.time_ns;
    return TACTUS_OK;
  });
}

tactus_status tactus_teleoperator_stop(tactus_teleoperator teleoperator, tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    const Running* const found = teleoperators().find(teleoperator);
    if (found == nullptr) {
      return leave_text("the handle is of no teleoperator, or it was released: start one", TACTUS_BAD_HANDLE, error);
    }
    const auto failure = found->session->stop();
    found->stopped->store(true);
    return failure ? leave(*failure, error) : TACTUS_OK;
  });
}

tactus_status tactus_teleoperator_report_read(tactus_teleoperator teleoperator, tactus_teleoperator_report* report) {
  return guarded(nullptr, [&]() -> tactus_status {
    if (!has_known_size(report)) return TACTUS_BAD_ARGUMENT;
    const Running* const found = teleoperators().find(teleoperator);
    if (found == nullptr) return TACTUS_BAD_HANDLE;
    if (!found->stopped->load()) return TACTUS_INCONSISTENT;
    const auto summary = found->session->summary();
    constexpr double s_per_ns = 1e-9;
    return fill(report, {.struct_size = 0,
                         .duration_s = summary.totals.duration_s,
                         .cycles = summary.totals.ticks,
                         .active_cycles = summary.totals.active_ticks,
                         .armings = summary.totals.armings,
                         .holds = summary.totals.holds,
                         .missed = summary.servo.missed,
                         .late = summary.servo.late_ours() + summary.servo.late_machine(),
                         .late_own = summary.servo.late_ours(),
                         .latest_start_s = s_per_ns * static_cast<double>(summary.servo.lateness.largest_ns()),
                         .log_dropped = summary.log_dropped});
  });
}

tactus_status tactus_teleoperator_release(tactus_teleoperator teleoperator) {
  return guarded(nullptr, [&]() -> tactus_status {
    return teleoperator == 0 || teleoperators().release(teleoperator) ? TACTUS_OK : TACTUS_BAD_HANDLE;
  });
}
