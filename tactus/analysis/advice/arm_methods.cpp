// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/arm_methods.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace tactus::advice {

namespace {

using experiments::ArmTappingParams;
using experiments::Settings;

constexpr const char* arm_method_key = "control.method";
constexpr const char* force_low_pass_key = "control.force_low_pass_Hz";
constexpr double even_damping_N_s_per_m = 20.0;  // of the leader's drives at the tool, in any direction

/// The leader.
bool elastic(const ArmTappingParams& params) { return params.arm.joint_stiffness_N_m_per_rad > 0.0; }

/// A coupling, with what only some of them use at rest.
Choice coupling(const ArmTappingParams& params, const char* method, std::string words, bool elastic_model,
                const Settings& more = {}) {
  Choice choice{.settings = {{arm_method_key, method}}, .words = std::move(words)};
  if (elastic(params)) choice.settings.emplace_back("control.model.joints", elastic_model ? "elastic" : "rigid");
  bool filtered = false;
  for (const auto& setting : more) {
    filtered = filtered || setting.first == force_low_pass_key;
    choice.settings.push_back(setting);
  }
  if (!filtered) choice.settings.emplace_back(force_low_pass_key, "0");
  return choice;
}

/// Damping of the leader's drives, `factor` times what the follower's have.
Choice drive_damping(const ArmTappingParams& params, std::size_t joints, double factor, double limit_N_s_per_m) {
  Choice choice;
  const Joints<arm_control::DriveGains> gains = params.control.follower.gains.of(joints);
  double most = 0.0;
  for (std::size_t i = 0; i < joints; ++i) {
    const double damping = std::min(rounded(factor * gains[i].damping_N_m_s_per_rad), most_drive_damping_N_m_s_per_rad);
    most = std::max(most, damping);
    choice.settings.emplace_back("control.drive_damping.joint_" + std::to_string(i + 1) + ".damping_N_m_s_per_rad",
                                 format_number(damping));
  }
  choice.settings.emplace_back("control.drive_damping_limit_N_s_per_m", format_number(limit_N_s_per_m));
  if (factor > 0.0) {
    choice.words = "up to " + format_number(most) + " N m s/rad in the leader's drives";
    if (limit_N_s_per_m > 0.0) choice.words += ", at the tool " + format_number(limit_N_s_per_m) + " N s/m at most";
  }
  return choice;
}

/// Limits at the follower's tool, with the torque of the wanted motion, without which they cost more lag than is
/// allowed.
Choice tool_limit(const ArmTappingParams& params, double stiffness_N_per_m, double damping_N_s_per_m) {
  const bool limited = stiffness_N_per_m > 0.0;
  Choice choice{.settings = {{"control.follower.tool_stiffness_limit_N_per_m", format_number(stiffness_N_per_m)},
                             {"control.follower.tool_damping_limit_N_s_per_m", format_number(damping_N_s_per_m)},
                             {"control.follower.wanted_motion.cutoff_Hz", !limited                       ? "0"
                                                                          : has_elastic_follower(params) ? "12"
                                                                                                         : "6"}}};
  if (limited) {
    choice.words = "the follower's tool held at " + format_number(stiffness_N_per_m) + " N/m";
    if (damping_N_s_per_m > 0.0) choice.words += " and " + format_number(damping_N_s_per_m) + " N s/m";
    choice.words += " at most and moved as the leader wants";
  }
  return choice;
}

Choice number_of(const char* key, double value, const char* words) {
  return {.settings = {{key, format_number(value)}}, .words = words, .tuned = key};
}

Choice observer(const char* joints, double cutoff_Hz, std::string words) {
  return {.settings = {{"control.follower.observer.joints", joints},
                       {"control.follower.observer.cutoff_Hz", format_number(cutoff_Hz)}},
          .words = std::move(words)};
}

}  // namespace

bool has_elastic_follower(const ArmTappingParams& params) {
  const experiments::ArmParams& other = params.arm.follower;
  return other.urdf.empty() ? elastic(params) : other.joint_stiffness_N_m_per_rad > 0.0;
}

std::vector<Dimension> arm_dimensions(const ArmTappingParams& params, std::size_t joints) {
  constexpr const char* damper = "control.damping_N_s_per_m";
  constexpr const char* command = "control.command_low_pass_Hz";
  constexpr const char* share = "control.follower.stiffness_share";
  constexpr const char* dead_band = "control.follower.observer.dead_band_share";
  const char* low_pass_words = "a low-pass of the command at {} Hz";
  Dimension couplings{coupling(params, "position-force", "position-force", false),
                      coupling(params, "cancellation", "cancellation", elastic(params)),
                      coupling(params, "feedback-avoidance", "feedback avoidance", false)};
  if (elastic(params)) {
    couplings.push_back(coupling(params, "cancellation", "cancellation with a rigid model", false));
  }
  std::vector<Dimension> dimensions{
      std::move(couplings),
      {drive_damping(params, joints, 0.0, 0.0), drive_damping(params, joints, 1.0, even_damping_N_s_per_m),
       drive_damping(params, joints, 2.0, even_damping_N_s_per_m),
       drive_damping(params, joints, 5.0, even_damping_N_s_per_m), drive_damping(params, joints, 5.0, 0.0)},
      {number_of(damper, 0.0, ""), number_of(damper, 12.0, "a damper of {} N s/m over the bus"),
       number_of(damper, 25.0, "a damper of {} N s/m over the bus"),
       number_of(damper, 40.0, "a damper of {} N s/m over the bus")},
      {number_of(command, 0.0, ""), number_of(command, 8.0, low_pass_words), number_of(command, 16.0, low_pass_words)},
      {number_of(share, 1.0, ""), number_of(share, 0.6, "{} of the follower's stiffness")},
      {tool_limit(params, 0.0, 0.0), tool_limit(params, 400.0, 8.0), tool_limit(params, 800.0, 16.0),
       tool_limit(params, 400.0, 0.0)}};
  if (params.control.follower.torque == arm_control::TorqueSource::sensor) return dimensions;
  dimensions.push_back({number_of(dead_band, 0.0, ""), number_of(dead_band, 1.0, "no force within friction")});
  if (has_elastic_follower(params)) {
    const double cutoff_Hz = params.control.follower.observer.cutoff_Hz;
    // That of rigid joints closes a loop here that needs no surface: a pair with it is none to begin at, or to compare
    // with.
    dimensions.push_back({observer("elastic", 20.0, "an observer of elastic joints at 20 Hz"),
                          observer("elastic", 30.0, "an observer of elastic joints at 30 Hz"),
                          observer("rigid", cutoff_Hz, "an observer of rigid joints")});
  }
  return dimensions;
}

Dimension arm_rivals(const ArmTappingParams& params) {
  constexpr const char* friction = "control.feed_forward.friction_share";
  return {
      coupling(params, "position-force", "a low-pass of the force at 5 Hz", false, {{force_low_pass_key, "5"}}),
      coupling(params, "position-position", "position-position", false),
      coupling(params, "factr", "FACTR without dither", false, {{friction, "0"}, {"control.factr.dither_share", "0"}}),
      coupling(params, "four-channel", "four-channel", false, {{friction, "0"}})};
}

Method bare_method(const std::vector<Dimension>& dimensions) {
  Method bare;
  for (const Dimension& dimension : dimensions) bare.choices.push_back(dimension.front());
  return bare;
}

std::vector<Method> neighbours(const Method& method, const std::vector<Dimension>& dimensions) {
  std::vector<Method> all;
  for (std::size_t i = 0; i < dimensions.size(); ++i) {
    for (const Choice& choice : dimensions[i]) {
      if (choice == method.choices[i]) continue;
      Method other = method;
      other.choices[i] = choice;
      all.push_back(std::move(other));
    }
  }
  return all;
}

}  // namespace tactus::advice
