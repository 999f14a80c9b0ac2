// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/replay_sites.hpp>
#include <tactus/runtime/servo/site_parts.hpp>

namespace tactus::runtime {

using control::SiteRole;
using station::DeviceReading;
using telemetry::LogContent;

namespace {

/// Both sites, of one axis or of joints that are driven each by itself.
template <class Reading, class Pair>
Check both(const LogContent& content, std::size_t joints, const station::TeleoperatorParams& params, Replay& replay) {
  return replay_both<Reading>(content, joints, replay, [&](auto& master, auto& slave) {
    const auto limits = master.limits();
    return station::DevicePair<Pair>::make(same_for_each(limits, params.control), params.channel,
                                           Seconds{1.0 / params.servo.rate_Hz}, same_for_each(limits, 0.0), master,
                                           slave);
  });
}

// Its number is told to the other site only.
constexpr std::int64_t own_session = 1;

Check alone(const LogContent& content, SiteRole role, const station::TeleoperatorParams& params, Replay& replay) {
  return replay_one<DeviceReading>(content, role, {}, 0, replay, [&](const station::DeviceLimits& limits) {
    return make_supervised_site(params, role, limits, own_session);
  });
}

}  // namespace

Check replay_joints(const LogContent& content, Replay& replay, const JointMakers& makers) {
  const auto only = only_site(content);
  const auto role = only.value_or(SiteRole::master);
  const std::string place = std::string("/") + name_of(role);
  const auto joints = joints_in(content, place);
  if (!joints) return joints.error();
  replay.of = std::string(only ? std::string("the ") + name_of(role) : "both sites") + " of " +
              std::to_string(*joints) + " joints";
  if (!only) {
    const auto of_slave = joints_in(content, "/slave");
    if (!of_slave) return of_slave.error();
    if (*of_slave != *joints) {
      return refuse_replay(ErrorCode::inconsistent, "the log has " + std::to_string(*joints) +
                                                        " joints at the master and " + std::to_string(*of_slave) +
                                                        " at the slave");
    }
    return makers.both(*joints);
  }
  const auto agreement = agreement_in(content);
  if (!agreement) return agreement.error();
  return replay_one<Joints<DeviceReading>>(
      content, role, place, *joints, replay,
      [&](const Joints<station::DeviceLimits>& limits) { return makers.one(role, limits, own_session, *agreement); });
}

Result<bool> replay_sites(const LogContent& content, const station::TeleoperatorParams& params, Replay& replay) {
  Check failed;
  if (is_of_joints(content)) {
    failed = replay_joints(content, replay,
                           {.both =
                                [&](std::size_t joints) {
                                  return both<Joints<DeviceReading>, station::JointSupervisedPair>(content, joints,
                                                                                                   params, replay);
                                },
                            .one =
                                [&](SiteRole role, const Joints<station::DeviceLimits>& limits, std::int64_t session,
                                    const control::Agreement& agreement) {
                                  return make_supervised_site(params, role, limits, session, agreement);
                                }});
  } else if (find_table(content, "/site") != nullptr) {
    const SiteRole role = only_site(content).value_or(SiteRole::master);
    replay.of = std::string("the ") + name_of(role);
    failed = alone(content, role, params, replay);
  } else if (find_table(content, "/master/site") != nullptr && find_table(content, "/slave/site") != nullptr) {
    replay.of = "both sites";
    failed = both<DeviceReading, station::SupervisedPair>(content, 0, params, replay);
  } else {
    return false;
  }
  if (failed) return *std::move(failed);
  return true;
}

}  // namespace tactus::runtime
