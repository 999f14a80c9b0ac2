// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/station/make_device_guard.hpp>
#include <tactus/runtime/servo/site_parts.hpp>

#include <charconv>
#include <span>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace tactus::runtime {

namespace {

using station::DeviceLimits;

constexpr std::pair<const char*, double DeviceLimits::*> limit_names[]{
    {"force_N", &DeviceLimits::force_N},
    {"handle_force_N", &DeviceLimits::handle_force_N},
    {"rate_N_per_s", &DeviceLimits::rate_N_per_s},
    {"velocity_m_per_s", &DeviceLimits::velocity_m_per_s},
    {"position_m", &DeviceLimits::position_m},
    {"velocity_step_m_per_s", &DeviceLimits::velocity_step_m_per_s},
    {"stiffness_N_per_m", &DeviceLimits::stiffness_N_per_m},
    {"damping_N_s_per_m", &DeviceLimits::damping_N_s_per_m}};

std::string joint_key(std::size_t joint, const char* name) { return "joint_" + std::to_string(joint + 1) + "." + name; }

/// Whether a word is a number, which it then is.
bool take_number(const Words& words, const std::string& key, double& number) {
  const auto found = words.find(key);
  if (found == words.end()) return false;
  const std::string& text = found->second;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  return read.ec == std::errc() && read.ptr == text.data() + text.size();
}

/// A site of either role, or what is wrong with it.
template <class Sites, class Site>
Result<Sites> as_site(Result<Site> made, const char* group) {
  if (!made) return under(group, made.error());
  return Sites(*std::move(made));
}

/// `Limits` of one axis or of several joints.
template <class Sites, class Limits>
Result<Sites> make_site(const station::TeleoperatorParams& params, control::SiteRole role, const Limits& limits,
                        std::int64_t session, const control::Agreement& agreement) {
  const Seconds tick{1.0 / params.servo.rate_Hz};
  const auto own = station::tightened(same_for_each(limits, params.control), role, limits);
  return role == control::SiteRole::master
             ? as_site<Sites>(control::make_supervised_master(own, session, tick, agreement), "control")
             : as_site<Sites>(control::make_supervised_slave(own, session, tick, agreement), "control");
}

}  // namespace

Result<SupervisedSite> make_supervised_site(const station::TeleoperatorParams& params, control::SiteRole role,
                                            const DeviceLimits& limits, std::int64_t session) {
  const Seconds tick{1.0 / params.servo.rate_Hz};
  return make_site<SupervisedSite>(params, role, limits, session, control::agreement_of(params.control, tick));
}

Result<JointSupervisedSite> make_supervised_site(const station::TeleoperatorParams& params, control::SiteRole role,
                                                 const Joints<DeviceLimits>& limits, std::int64_t session,
                                                 const control::Agreement& agreement) {
  return make_site<JointSupervisedSite>(params, role, limits, session, agreement);
}

Result<JointSupervisedSite> make_supervised_site(const station::ArmTeleoperatorParams& params,
                                                 const station::DescribedArms& arms, control::SiteRole role,
                                                 const Joints<DeviceLimits>& limits, std::int64_t session,
                                                 const control::Agreement& agreement) {
  const station::ArmSiteStart start{.session = session, .agreement = agreement};
  return role == control::SiteRole::master
             ? as_site<JointSupervisedSite>(station::arm_leader_site(params, arms, limits, start), "")
             : as_site<JointSupervisedSite>(station::arm_follower_site(params, arms, limits, start), "");
}

double force_step_limit_N(const station::TeleoperatorParams& params, control::SiteRole role,
                          const DeviceLimits& limits) {
  const control::ControlParams own = station::tightened(params.control, role, limits);
  const auto& gate = role == control::SiteRole::master ? own.gate : own.slave_gate;
  return gate.rate_limit_N_per_s * (1.0 / params.servo.rate_Hz);
}

Words in_words(const DeviceLimits& limits) {
  Words words;
  for (const auto& [name, member] : limit_names) words[name] = format_number(limits.*member);
  return words;
}

DeviceLimits limits_in(const Words& words) {
  DeviceLimits limits;
  for (const auto& [name, member] : limit_names) {
    if (!take_number(words, name, limits.*member)) limits.*member = 0.0;
  }
  return limits;
}

Words in_words(const Joints<DeviceLimits>& limits) {
  Words words;
  for (std::size_t joint = 0; joint < limits.size(); ++joint) {
    for (const auto& [name, member] : limit_names) {
      words[joint_key(joint, name)] = format_number(limits[joint].*member);
    }
  }
  return words;
}

Result<Joints<DeviceLimits>> limits_in(const Words& words, std::size_t joints) {
  Joints<DeviceLimits> limits(joints);
  for (std::size_t joint = 0; joint < joints; ++joint) {
    for (const auto& [name, member] : limit_names) {
      const std::string key = joint_key(joint, name);
      if (take_number(words, key, limits[joint].*member)) continue;
      return Error{.code = ErrorCode::missing, .parameter = key, .message = "is not a number there", .place = {}};
    }
  }
  return limits;
}

std::string text_of(const control::Agreement& agreement) {
  std::ostringstream text;
  text << std::hex << agreement.digest();
  for (std::size_t cell = 0; cell < agreement.size(); ++cell) text << ' ' << agreement[cell];
  return text.str();
}

std::optional<control::Agreement> agreement_from(const std::string& text) {
  std::istringstream words(text);
  std::vector<std::uint64_t> numbers;
  for (std::string word; words >> word;) {
    std::uint64_t number = 0;
    const char* const end = word.data() + word.size();
    const auto read = std::from_chars(word.data(), end, number, 16);
    if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
    numbers.push_back(number);
  }
  if (numbers.empty() || numbers.size() > control::Agreement::most_cells + 1) return std::nullopt;
  return control::Agreement(numbers[0], std::span(numbers).subspan(1));
}

Words urdfs_of(const station::DescribedArms& arms) {
  return {{arms.leader.urdf, arms.leader.urdf_text}, {arms.follower.urdf, arms.follower.urdf_text}};
}

urdf::Urdfs urdfs_in(const Words& words) {
  return [words](const std::string& name) -> Result<urdf::UrdfText> {
    const auto found = words.find(name);
    if (found != words.end()) return urdf::UrdfText{found->second, name};
    return Error{.code = ErrorCode::missing, .parameter = {}, .message = "is not in the log", .place = name};
  };
}

}  // namespace tactus::runtime
