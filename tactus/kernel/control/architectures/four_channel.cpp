// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/four_channel.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::control {

namespace {

Check check_share(const char* parameter, double share, const char* loop_parameter, double loop_gain) {
  constexpr double round_off = 1e-12;
  const double transparent = 1.0 + loop_gain;
  if (std::fabs(share - transparent) <= round_off * std::max(1.0, transparent)) return {};
  return Error{.code = ErrorCode::inconsistent,
               .parameter = parameter,
               .message = rounded_number(share) + " does not meet the condition of transparency: write " +
                          rounded_number(transparent) + ", 1 + " + loop_parameter,
               .place = {}};
}

Result<FilteredAcceleration> make_acceleration(const FourChannelParams& channels, Seconds dt) {
  const auto derivative = signal::FilteredDerivative::make(channels.acceleration, dt);
  if (!derivative) return under("four_channel.acceleration", derivative.error());
  return FilteredAcceleration(*derivative);
}

}  // namespace

Check check_transparency(const FourChannelParams& params) {
  if (auto error = validate(params)) return error;
  if (auto error = check_share("environment_force_gain", params.environment_force_gain, "master_force_loop_gain",
                               params.master_force_loop_gain)) {
    return error;
  }
  if (auto error = check_share("hand_force_gain", params.hand_force_gain, "slave_force_loop_gain",
                               params.slave_force_loop_gain)) {
    return error;
  }
  if (params.master_force_loop_gain > -1.0 || params.slave_force_loop_gain > -1.0) return {};
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "master_force_loop_gain",
               .message =
                   "-1 on both sites takes force out of the loop altogether: raise this one or "
                   "slave_force_loop_gain",
               .place = {}};
}

Result<FourChannelMaster> FourChannelMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto servo = ServoPd::make(params.four_channel.master, dt);
  if (!servo) return under("four_channel.master", servo.error());
  const auto acceleration = make_acceleration(params.four_channel, dt);
  if (!acceleration) return acceleration.error();
  return FourChannelMaster(params, *servo, *acceleration);
}

FourChannelMaster::Output FourChannelMaster::respond(const Input& input) noexcept {
  const FourChannelParams& channels = params_.four_channel;
  const Message& slave = input.arrival.message;
  const double slave_position_m = slave.position_m / params_.position_scale;
  const double force_N = servo_.step(slave_position_m - input.motor_position_m) +
                         channels.master_feedforward_kg * slave_acceleration_.step(slave_position_m) -
                         params_.force_gain * channels.environment_force_gain * slave.force_N +
                         channels.master_force_loop_gain * input.hand_force_N;
  // A NaN passes through clamp, so it reaches the gate, which catches and latches it.
  return {.motor_force_N = std::clamp(force_N, -params_.force_limit_N, params_.force_limit_N),
          .message = {.position_m = params_.position_scale * input.motor_position_m, .force_N = input.hand_force_N},
          .intended_position_m = input.motor_position_m};
}

Result<FourChannelSlave> FourChannelSlave::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const FourChannelParams& channels = params.four_channel;
  if (params.force_gain == 0.0 && channels.hand_force_gain > 0.0) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "force_gain",
                 .message =
                     "0 leaves no scale for the hand force on the slave, hand_force_gain over force_gain: raise "
                     "it, or set four_channel.hand_force_gain to 0",
                 .place = {}};
  }
  const auto servo = ServoPd::make(params.slave, dt);
  if (!servo) return under("slave", servo.error());
  const auto acceleration = make_acceleration(channels, dt);
  if (!acceleration) return acceleration.error();
  const double hand_force_gain = channels.hand_force_gain > 0.0 ? channels.hand_force_gain / params.force_gain : 0.0;
  return FourChannelSlave(channels, hand_force_gain, *servo, *acceleration);
}

FourChannelSlave::Output FourChannelSlave::respond(const Input& input) noexcept {
  const Message& master = input.arrival.message;
  return {.motor_force_N = servo_.step(master.position_m - input.motor_position_m) +
                           feedforward_kg_ * master_acceleration_.step(master.position_m) -
                           force_loop_gain_ * input.tip_force_N + hand_force_gain_ * master.force_N,
          .message = {.position_m = input.motor_position_m, .force_N = input.tip_force_N}};
}

Result<CancellingSlave> CancellingSlave::make(const Params& params, Seconds dt) {
  PositionForceMaster::Params cancelling = params.master;
  cancelling.cancellation = CancellationMode::on;
  const auto master = PositionForceMaster::make(cancelling, dt);
  if (!master) return master.error().parameter == "dt" ? master.error() : under("master", master.error());
  const auto servo = ServoPd::make(params.slave, dt);
  if (!servo) return under("slave", servo.error());
  return CancellingSlave(params.master.position_scale, *master, *servo);
}

CancellingSlave::Output CancellingSlave::respond(const Input& input) noexcept {
  const auto cancelled = master_.step({.motor_position_m = input.arrival.message.position_m / position_scale_,
                                       .arrival = {.message = {.force_N = sent_force_N_}, .fresh = true}});
  sent_force_N_ = input.tip_force_N;
  return {.motor_force_N = servo_.step(cancelled.message.position_m - input.motor_position_m),
          .message = {.force_N = input.tip_force_N}};
}

namespace {

Result<Controllers> make_four_channel(const ControlParams& params, Seconds dt) {
  const auto master = FourChannelMaster::make({.position_scale = params.position_scale,
                                               .force_gain = params.force_gain,
                                               .force_limit_N = params.force_limit_N,
                                               .four_channel = params.own<FourChannelParams>()},
                                              dt);
  if (!master) return master.error();
  const auto slave = FourChannelSlave::make(
      {.force_gain = params.force_gain, .slave = params.slave, .four_channel = params.own<FourChannelParams>()}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

/// The slave computes with the master's force gain, so the gain may not change while the loop runs: this master offers
/// no `set_force_gain`.
class FixedGainMaster {
 public:
  explicit FixedGainMaster(const PositionForceMaster& master) : master_(master) {}
  MasterOutput respond(const MasterInput& input) noexcept { return master_.respond(input); }
  void applied(double motor_force_N) noexcept { master_.applied(motor_force_N); }
  void reset() noexcept { master_.reset(); }

 private:
  PositionForceMaster master_;
};

Result<Controllers> make_four_channel_cancellation(const ControlParams& params, Seconds dt) {
  PositionForceMaster::Params plain = params;
  plain.cancellation = CancellationMode::off;
  const auto master = PositionForceMaster::make(plain, dt);
  if (!master) return master.error();
  const auto slave = CancellingSlave::make({.master = params, .slave = params.slave}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(FixedGainMaster(*master)), slave_controller(*slave)};
}

}  // namespace

Architecture four_channel_architecture() {
  return {.name = "four-channel",
          .summary = "both sites send position and force (Lawrence), with local force loops",
          .make = make_four_channel,
          .keys = own_keys<FourChannelParams>("four_channel", "Architecture four-channel: gains of its channels.")};
}

Architecture four_channel_cancellation_architecture() {
  return {.name = "four-channel-cancellation",
          .summary = "position-force with cancellation as the slave's local force loop (paper A, appendix)",
          .make = make_four_channel_cancellation};
}

}  // namespace tactus::control
