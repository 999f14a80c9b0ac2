// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/replay_sites.hpp>
#include <tactus/runtime/servo/site_parts.hpp>

namespace tactus::runtime {

using Reading = Joints<station::DeviceReading>;
using Limits = Joints<station::DeviceLimits>;

Result<bool> replay_arms(const telemetry::LogContent& content, const station::ArmTeleoperatorParams& params,
                         const station::DescribedArms& arms, Replay& replay) {
  if (!is_of_joints(content)) return false;
  Check failed = replay_joints(
      content, replay,
      {.both =
           [&](std::size_t joints) {
             return replay_both<Reading>(
                 content, joints, replay, [&](auto& master, auto& slave) -> Result<station::JointLocalTeleoperator> {
                   auto sites = station::arm_sites(params, arms, master.limits(), slave.limits());
                   if (!sites) return sites.error();
                   return station::JointLocalTeleoperator::around(*std::move(sites), master, slave);
                 });
           },
       .one =
           [&](control::SiteRole role, const Limits& limits, std::int64_t session,
               const control::Agreement& agreement) {
             return make_supervised_site(params, arms, role, limits, session, agreement);
           }});
  if (failed) return *std::move(failed);
  return true;
}

}  // namespace tactus::runtime
