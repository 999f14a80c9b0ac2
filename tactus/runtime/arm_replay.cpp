#include <tactus/experiments/arm_tapping/arm_taps.hpp>
#include <tactus/runtime/internal/replay_sites.hpp>
#include <tactus/runtime/site_parts.hpp>

#include <optional>

namespace tactus::runtime {

using control::SiteRole;
using station::DeviceReading;
using telemetry::LogContent;

namespace {

using Reading = Joints<DeviceReading>;
using Limits = Joints<station::DeviceLimits>;
using Rows = std::array<JointsRow, 2>;

/// Taps of simulated arms, whose sites are bare.
Check replay_arm_taps(const LogContent& content, const experiments::ArmTappingParams& params,
                      const experiments::Urdfs& urdfs, Replay& replay) {
  const auto taps = experiments::ArmTaps::make(params, urdfs);
  if (!taps) return taps.error();
  const std::size_t joints = taps->setup().leader.joints.size();
  for (const char* place : {"/master", "/slave"}) {
    const auto found = joints_in(content, place);
    if (!found) return found.error();
    if (*found == joints) continue;
    return refuse_replay(ErrorCode::inconsistent, "the log has " + std::to_string(*found) + " joints below " + place +
                                                      ", and its arm has " + std::to_string(joints));
  }
  const auto at_master = SiteTables<Reading>::find(content, "/master", joints);
  if (!at_master) return at_master.error();
  const auto at_slave = SiteTables<Reading>::find(content, "/slave", joints);
  if (!at_slave) return at_slave.error();
  RecordedDeviceOf<Reading> master{Limits(joints)}, slave{Limits(joints)};
  std::optional<station::JointBarePair> sites;
  auto failed = replay_rows<Reading, 2>(
      {*at_master, *at_slave}, content.summary.complete, true, replay,
      [&](std::int64_t tap, const station::Tick& tick, const Rows& logged) -> Result<Rows> {
        if (tick.number == 0) {
          const auto number = static_cast<std::size_t>(tap);
          if (number >= taps->size()) {
            return refuse_replay(ErrorCode::inconsistent, "the log has a tap that its configuration has not");
          }
          auto made = experiments::bare_arm_sites(taps->setup(), taps->tap(number).model_params);
          if (!made) return made.error();
          sites.emplace(*std::move(made));
        }
        feed(master, logged[0]);
        feed(slave, logged[1]);
        const Joints<control::Message> heard = sites->at_master();
        const auto done = sites->step(master, slave, tick, 1.0);
        const auto told = member_of_each(done.master.output, &control::MasterOutput::message);
        return Rows{row_of_step(tick, sites->master(), done.master, heard),
                    row_of_step(tick, sites->slave(), done.slave, told)};
      });
  replay.of = std::to_string(replay.taps) + " taps of two arms";
  return failed;
}

}  // namespace

Result<bool> replay_arms(const LogContent& content, const experiments::ArmTappingParams& params, Replay& replay) {
  if (!is_of_joints(content)) return false;
  const auto words = content.summary.metadata.find("urdf");
  if (words == content.summary.metadata.end()) {
    return refuse_replay(ErrorCode::missing,
                         "the log does not have the URDF of its arms (urdf): it is of an earlier version, which did "
                         "not leave it, so it is not replayed; record it again");
  }
  const experiments::Urdfs urdfs = urdfs_in(words->second);
  Check failed;
  if (about(content, "tactus", "rig").empty()) {
    failed = replay_arm_taps(content, params, urdfs, replay);
  } else {
    const auto setup = experiments::set_up_arm_pair(params, urdfs);
    if (!setup) return setup.error();
    failed = replay_joints(
        content, replay,
        {.both =
             [&](std::size_t joints) {
               return replay_both<Reading>(
                   content, joints, replay, [&](auto& master, auto& slave) -> Result<station::JointLocalTeleoperator> {
                     auto sites = experiments::arm_sites(*setup, master.limits(), slave.limits());
                     if (!sites) return sites.error();
                     return station::JointLocalTeleoperator::around(*std::move(sites), master, slave);
                   });
             },
         .one =
             [&](SiteRole role, const Limits& limits, std::int64_t session, const control::Agreement& agreement) {
               return make_supervised_site(*setup, role, limits, session, agreement);
             }});
  }
  if (failed) return *std::move(failed);
  return true;
}

}  // namespace tactus::runtime
