// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/signal/low_pass.hpp>

/// Shared compliant control: the slave yields to what it touches without waiting for the operator.
namespace tactus::control {

/// How far and how fast the slave's command yields.
struct ComplianceParams {
  double stiffness_N_per_m = 100.0;
  double cutoff_Hz = 2.0;
  static constexpr auto fields() {
    return List{field("stiffness_N_per_m", &ComplianceParams::stiffness_N_per_m, units::newton_per_metre,
                      Bounds{.lower = 1.0, .upper = 1e6},
                      "Tip force divided by the distance by which the slave's command yields in the steady state."),
                field("cutoff_Hz", &ComplianceParams::cutoff_Hz, units::hertz, positive,
                      "Low-pass on the tip force to which the command yields; below half the sample rate.")};
  }
};

/// The slave site: position-force control on a command that yields to the tip force,
///
///     x_d = x_cmd − F̄_e / K_c,    F̄_e = F_e low-passed at `cutoff_Hz`.
///
/// At rest the tip is as soft as the servo, K_c and the mechanism in series. The yielding is local, so delay leaves it
/// untouched; it moves the balance of a press from the operator, who knows of it a round trip late, to the slave. The
/// tip force goes to the master as measured.
///
/// Against a wall the local loop has the gain k_p/K_c below the cutoff and one low-pass, so while the tip stays in
/// contact it is stable. But a command that yields much and fast takes the tip off the wall, and the contact bounces:
/// with the default servo, from 5 Hz up at k_p/K_c = 1, while 2 Hz settles there. So keep the cutoff low.
/// Source: Kim, Hannaford and Bejczy, Force-reflection and shared compliant control in operating telemanipulators with
/// time delay, 1992.
class SharedCompliantSlave {
 public:
  struct Params {
    ServoPd::Params slave;
    ComplianceParams compliance;
    static constexpr auto fields() {
      return List{field("slave", &Params::slave, "The slave's position controller."),
                  field("compliance", &Params::compliance, "How the slave's command yields to the tip force.")};
    }
  };
  using Input = SlaveInput;
  using Output = SlaveOutput;

  static Result<SharedCompliantSlave> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    const auto following = PositionForceSlave::make(params.slave, dt);
    if (!following) return under("slave", following.error());
    const auto yielding = signal::LowPass::make({.cutoff_Hz = params.compliance.cutoff_Hz}, dt);
    if (!yielding) return under("compliance", yielding.error());
    return SharedCompliantSlave(params.compliance.stiffness_N_per_m, *following, *yielding);
  }

  /// Real-time safe.
  Output respond(const Input& input) noexcept {
    Input yielded = input;
    yielded.arrival.message.position_m -= yielding_.step(input.tip_force_N) / stiffness_N_per_m_;
    return following_.respond(yielded);
  }
  Output step(const Input& input) noexcept { return respond(input); }
  void reset() noexcept {
    following_.reset();
    yielding_.reset();
  }

 private:
  SharedCompliantSlave(double stiffness_N_per_m, const PositionForceSlave& following, const signal::LowPass& yielding)
      : stiffness_N_per_m_(stiffness_N_per_m), following_(following), yielding_(yielding) {}

  double stiffness_N_per_m_;
  PositionForceSlave following_;
  signal::LowPass yielding_;
};

}  // namespace tactus::control
