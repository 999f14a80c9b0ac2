#include <tactus/control/agreed_parameters.hpp>
#include <tactus/experiments/model_mismatch.hpp>
#include <tactus/runtime/site_parts.hpp>
#include <tactus/station/wall.hpp>

#include <charconv>
#include <utility>

namespace tactus::runtime {

namespace {

using station::DeviceLimits;

constexpr std::pair<const char*, double DeviceLimits::*> limit_names[]{
    {"force_N", &DeviceLimits::force_N},
    {"handle_force_N", &DeviceLimits::handle_force_N},
    {"rate_N_per_s", &DeviceLimits::rate_N_per_s},
    {"velocity_m_per_s", &DeviceLimits::velocity_m_per_s},
    {"position_m", &DeviceLimits::position_m}};

}  // namespace

control::ControlParams control_of(const experiments::TappingParams& params) {
  control::ControlParams control = params.control;
  control.model = experiments::mismatched(control.model, params.task.mismatch);
  return control;
}

Result<SupervisedSite> make_supervised_site(const experiments::TappingParams& params, control::SiteRole role,
                                            const DeviceLimits& limits, std::int64_t session) {
  const Seconds tick{1.0 / params.servo.rate_Hz};
  const control::ControlParams control = control_of(params);
  const control::ControlParams own = station::tightened(control, role, limits);
  const control::Agreement agreement = control::agreement_of(control, tick);
  if (role == control::SiteRole::master) {
    auto made = control::make_supervised_master(own, session, tick, agreement);
    if (!made) return under("control", made.error());
    return SupervisedSite(*std::move(made));
  }
  auto made = control::make_supervised_slave(own, session, tick, agreement);
  if (!made) return under("control", made.error());
  return SupervisedSite(*std::move(made));
}

double force_step_limit_N(const experiments::TappingParams& params, control::SiteRole role,
                          const DeviceLimits& limits) {
  const control::ControlParams own = station::tightened(params.control, role, limits);
  const auto& gate = role == control::SiteRole::master ? own.gate : own.slave_gate;
  return gate.rate_limit_N_per_s * (1.0 / params.servo.rate_Hz);
}

std::map<std::string, std::string> in_words(const DeviceLimits& limits) {
  std::map<std::string, std::string> words;
  for (const auto& [name, member] : limit_names) words[name] = format_number(limits.*member);
  return words;
}

DeviceLimits limits_in(const std::map<std::string, std::string>& words) {
  DeviceLimits limits;
  for (const auto& [name, member] : limit_names) {
    const auto found = words.find(name);
    if (found == words.end()) continue;
    const std::string& text = found->second;
    std::from_chars(text.data(), text.data() + text.size(), limits.*member);
  }
  return limits;
}

}  // namespace tactus::runtime
