#pragma once

#include <tactus/control/supervised_site.hpp>
#include <tactus/core/result.hpp>
#include <tactus/experiments/tapping/tapping.hpp>
#include <tactus/station/device.hpp>

#include <map>
#include <string>
#include <variant>

/// What a site is made of, be it stepped at the real clock or from its log.
namespace tactus::runtime {

using SupervisedSite = std::variant<control::SupervisedMaster, control::SupervisedSlave>;

/// What the controllers of an experiment work by, the mismatch of its task included.
control::ControlParams control_of(const experiments::TappingParams& params);

/// One site of the experiment before a device with these limits; `session` as in `control::make_supervised_master`.
/// What the device allows is this site's own affair and no part of its agreement with the other. Errors name `control`.
Result<SupervisedSite> make_supervised_site(const experiments::TappingParams& params, control::SiteRole role,
                                            const station::DeviceLimits& limits, std::int64_t session);

/// The force step that the gate of a site allows in a tick, in N.
double force_step_limit_N(const experiments::TappingParams& params, control::SiteRole role,
                          const station::DeviceLimits& limits);

/// Limits of a device as a log carries them, and back; what is no number there is 0.
std::map<std::string, std::string> in_words(const station::DeviceLimits& limits);
station::DeviceLimits limits_in(const std::map<std::string, std::string>& words);

}  // namespace tactus::runtime
