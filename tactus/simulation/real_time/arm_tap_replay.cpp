// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/replay_sites.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/simulation/real_time/replay.hpp>

#include <optional>

namespace tactus::real_time {

using control::SiteRole;
using station::DeviceReading;
using telemetry::LogContent;

namespace {

using Reading = Joints<DeviceReading>;
using Limits = Joints<station::DeviceLimits>;
using Rows = std::array<runtime::JointsRow, 2>;

}  // namespace

Check replay_arm_taps(const LogContent& content, const experiments::ArmTappingParams& params, const urdf::Urdfs& urdfs,
                      runtime::Replay& replay) {
  const auto taps = experiments::ArmTaps::make(params, urdfs);
  if (!taps) return taps.error();
  const std::size_t joints = taps->setup().leader.joints.size();
  for (const char* place : {"/master", "/slave"}) {
    const auto found = runtime::joints_in(content, place);
    if (!found) return found.error();
    if (*found == joints) continue;
    return runtime::refuse_replay(ErrorCode::inconsistent, "the log has " + std::to_string(*found) + " joints below " +
                                                               place + ", and its arm has " + std::to_string(joints));
  }
  const auto at_master = runtime::SiteTables<Reading>::find(content, "/master", joints);
  if (!at_master) return at_master.error();
  const auto at_slave = runtime::SiteTables<Reading>::find(content, "/slave", joints);
  if (!at_slave) return at_slave.error();
  runtime::RecordedDeviceOf<Reading> master{Limits(joints)}, slave{Limits(joints)};
  std::optional<station::JointBarePair> sites;
  auto failed = runtime::replay_rows<Reading, 2>(
      {*at_master, *at_slave}, content.summary.complete, true, replay,
      [&](std::int64_t tap, const station::Tick& tick, const Rows& logged) -> Result<Rows> {
        if (tick.number == 0) {
          const auto number = static_cast<std::size_t>(tap);
          if (number >= taps->size()) {
            return runtime::refuse_replay(ErrorCode::inconsistent, "the log has a tap that its configuration has not");
          }
          auto made = experiments::bare_arm_sites(taps->setup(), taps->tap(number).model_params);
          if (!made) return made.error();
          sites.emplace(*std::move(made));
        }
        runtime::feed(master, logged[0]);
        runtime::feed(slave, logged[1]);
        const Joints<control::Message> heard = sites->at_master();
        const auto done = sites->step(master, slave, tick, 1.0);
        const auto told = member_of_each(done.master.output, &control::MasterOutput::message);
        return Rows{runtime::row_of_step(tick, sites->master(), done.master, heard),
                    runtime::row_of_step(tick, sites->slave(), done.slave, told)};
      });
  replay.of = std::to_string(replay.taps) + " taps of two arms";
  return failed;
}

}  // namespace tactus::real_time
