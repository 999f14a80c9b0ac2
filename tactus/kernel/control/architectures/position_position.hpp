// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>

/// Position-position control, or bilateral position error: each device is pulled toward the other. No force sensor.
/// One class for each site.
namespace tactus::control {

/// The master site: position-force control whose force is not measured but is the effort of following,
///
///     e = λ x_m − x_s,    F_e = k_p e + k_d ė,    F_m = −sat(μ F_e),
///
/// with the gains of the slave's servo, so that without delay F_e is the force of the slave's motor and μ means what it
/// means in position-force control. For μ = λ the two sites are a spring and a damper between the devices, scaled, and
/// give off no power; sampled, while k_d > k_p·dt/2 (Colgate and Brown). Any other μ is an amplifier. A round trip of d
/// is felt as drag: at steady speed v, with a slave that keeps up, F_e = k_p λ v d.
///
/// e holds the measured position, cancellation or not: the hand feels where the slave is, not where it was commanded to
/// be. Before the first packet of the slave there is no error and no force; while it does not respond, its last
/// position counts. Source: Lawrence, Stability and transparency in bilateral teleoperation, 1993 (position-position as
/// the case of his general architecture that has position channels alone).
class PositionPositionMaster {
 public:
  struct Params {
    PositionForceMaster::Params position_force;
    ServoPd::Params coupling;
    static constexpr auto fields() {
      return List{
          field("position_force", &Params::position_force, "Command path, scales and limit, as in position-force."),
          field("coupling", &Params::coupling, "What pulls the master toward the slave: the slave's own gains.")};
    }
  };
  using Input = MasterInput;
  using Output = MasterOutput;

  static Result<PositionPositionMaster> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    const auto display = PositionForceMaster::make(params.position_force, dt);
    if (!display) return under("position_force", display.error());
    const auto coupling = ServoPd::make(params.coupling, dt);
    if (!coupling) return under("coupling", coupling.error());
    return PositionPositionMaster(params.position_force.position_scale, *display, *coupling);
  }

  /// Real-time safe.
  Output respond(const Input& input) noexcept {
    heard_ = heard_ || input.arrival.fresh;
    Input with_force = input;
    with_force.arrival.message.force_N =
        heard_ ? coupling_.step(position_scale_ * input.motor_position_m - input.arrival.message.position_m) : 0.0;
    return display_.respond(with_force);
  }
  void applied(double motor_force_N) noexcept { display_.applied(motor_force_N); }
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  [[nodiscard]] double force_gain() const noexcept { return display_.force_gain(); }
  /// From the next tick on. Real-time safe.
  void set_force_gain(double gain) noexcept { display_.set_force_gain(gain); }
  void reset() noexcept {
    display_.reset();
    coupling_.reset();
    heard_ = false;
  }

 private:
  PositionPositionMaster(double position_scale, const PositionForceMaster& display, const ServoPd& coupling)
      : position_scale_(position_scale), display_(display), coupling_(coupling) {}

  double position_scale_;
  PositionForceMaster display_;
  ServoPd coupling_;
  bool heard_ = false;
};

/// The slave site: follows as in position-force control, and reports where it is instead of what it touches.
class PositionPositionSlave {
 public:
  using Params = PositionForceSlave::Params;
  using Input = SlaveInput;
  using Output = SlaveOutput;

  static Result<PositionPositionSlave> make(const Params& params, Seconds dt) {
    const auto following = PositionForceSlave::make(params, dt);
    if (!following) return following.error();
    return PositionPositionSlave(*following);
  }

  /// Real-time safe.
  Output respond(const Input& input) noexcept {
    Output output = following_.respond(input);
    output.message = {.position_m = input.motor_position_m};
    return output;
  }
  Output step(const Input& input) noexcept { return respond(input); }
  void reset() noexcept { following_.reset(); }

 private:
  explicit PositionPositionSlave(const PositionForceSlave& following) : following_(following) {}
  PositionForceSlave following_;
};

}  // namespace tactus::control
