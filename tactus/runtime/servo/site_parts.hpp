// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/urdf/described_arms.hpp>
#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>
#include <tactus/kernel/station/teleoperator_params.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>

/// What a site is made of, be it stepped at the real clock or from its log.
namespace tactus::runtime {

using SupervisedSite = std::variant<control::SupervisedMaster, control::SupervisedSlave>;
/// Of several joints.
using JointSupervisedSite = std::variant<control::JointSupervisedMaster, control::JointSupervisedSlave>;

/// One site of a teleoperator before a device with these limits; `session` as in `control::make_supervised_master`.
/// What the device allows is this site's own affair and no part of its agreement with the other. Errors name `control`.
Result<SupervisedSite> make_supervised_site(const station::TeleoperatorParams& params, control::SiteRole role,
                                            const station::DeviceLimits& limits, std::int64_t session);
/// The same of joints that are driven each by itself, and of an arm. `agreement` as in
/// `control::make_supervised_master`. Errors of an arm are those of `station::arm_leader_site`.
Result<JointSupervisedSite> make_supervised_site(const station::TeleoperatorParams& params, control::SiteRole role,
                                                 const Joints<station::DeviceLimits>& limits, std::int64_t session,
                                                 const control::Agreement& agreement);
Result<JointSupervisedSite> make_supervised_site(const station::ArmTeleoperatorParams& params,
                                                 const station::DescribedArms& arms, control::SiteRole role,
                                                 const Joints<station::DeviceLimits>& limits, std::int64_t session,
                                                 const control::Agreement& agreement);

/// The force step that the gate of a site allows in a tick, in N.
double force_step_limit_N(const station::TeleoperatorParams& params, control::SiteRole role,
                          const station::DeviceLimits& limits);

/// What a log states about one thing: values by their keys.
using Words = std::map<std::string, std::string>;

/// Limits of a device as a log has them, and back; a value there that is not a number is 0.
Words in_words(const station::DeviceLimits& limits);
station::DeviceLimits limits_in(const Words& words);
/// The same of several joints, under `joint_1` and on. Errors: `missing` where one of the limits is not a number.
Words in_words(const Joints<station::DeviceLimits>& limits);
Result<Joints<station::DeviceLimits>> limits_in(const Words& words, std::size_t joints);

/// What a site has in common with the other as a log carries it: its digest, then its cells. And back; nothing where
/// that is no such text.
std::string text_of(const control::Agreement& agreement);
std::optional<control::Agreement> agreement_from(const std::string& text);

/// The URDFs of arms by their names, as a log carries them, so that it replays wherever the files are by then.
Words urdfs_of(const station::DescribedArms& arms);
/// And back. Errors: `missing` for one that is not among them.
urdf::Urdfs urdfs_in(const Words& words);

}  // namespace tactus::runtime
