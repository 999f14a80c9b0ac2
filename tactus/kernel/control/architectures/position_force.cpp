// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <string>
#include <string_view>
#include <utility>

namespace tactus::control {

Result<PositionForceMaster> PositionForceMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  Check failed;
  const auto made = each_stage<Result>(params, [&]<class Stage>(const char* name, const typename Stage::Params& own) {
    auto stage = Stage::make(own, dt);
    if (!stage && !failed) {
      failed = stage.error();
      failed->parameter = site_key(name, failed->parameter);
    }
    return stage;
  });
  if (failed) return *std::move(failed);
  return PositionForceMaster(params, {.force_filter = *made.force_filter,
                                      .crossover = *made.crossover,
                                      .hand_compensation = *made.hand_compensation,
                                      .damping = *made.damping,
                                      .command_filter = *made.command_filter,
                                      .cancellation = *made.cancellation});
}

std::string PositionForceMaster::site_key(std::string_view name, std::string_view own) {
  constexpr std::string_view model = "cancellation.model.master";
  if (name == "hand_compensation") return own == "band_Hz" ? "hand_compensation_Hz" : std::string(own);
  if (name == "cancellation") {
    if (own == "estimate") return "operator_estimate";
    if (own == "cancellation.model.step") return "cancellation_step";
    return own.starts_with(model) ? std::string("model").append(own.substr(model.size())) : std::string(own);
  }
  return own.empty() ? std::string(name) : std::string(name).append(".").append(own);
}

Result<PositionForceSlave> PositionForceSlave::make(const Params& params, Seconds dt) {
  const auto servo = ServoPd::make(params, dt);
  if (!servo) return servo.error();
  return PositionForceSlave(*servo);
}

namespace {

Result<Controllers> make_position_force(const ControlParams& params, Seconds dt) {
  const auto master = PositionForceMaster::make(params, dt);
  if (!master) return master.error();
  const auto slave = PositionForceSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

}  // namespace

Architecture position_force_architecture() {
  return {.name = "position-force",
          .summary = "the slave follows the master's position, the master displays the slave's tip force",
          .make = make_position_force,
          .like_position_force = Likeness::equal};
}

}  // namespace tactus::control
