#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cmath>

/// The keys of this class: the group `[control.soft_limit]` of a file.
struct SoftLimitParams {
  double linear_fraction = 0.5;
  static constexpr auto fields() {
    return tactus::List{tactus::field("linear_fraction", &SoftLimitParams::linear_fraction, tactus::units::none,
                                      tactus::between(0.1, 0.9),
                                      "Share of the force limit up to which the force is displayed as it is.")};
  }
};

/// A master site that displays force as position-force control does, but lets the force approach its limit smoothly
/// instead of clipping it. The display saturates at the tip force F_max = force_limit_N / force_gain. F_l is the share
/// `linear_fraction` of F_max. In place of the tip force F, the position-force site receives
///
///     F                                                       up to F_l
///     sign(F)·(F_l + (F_max − F_l)·tanh((|F| − F_l) / (F_max − F_l)))   above
///
/// Value and slope are continuous, and the slope falls from one to zero, so the loop's gain falls as the force grows.
/// The library's position-force site does everything else: gain, cancellation and command.
class SoftLimitMaster {
 public:
  struct Params {
    tactus::control::PositionForceMaster::Params site;
    SoftLimitParams soft_limit;
    static constexpr auto fields() {
      return tactus::List{tactus::field("site", &Params::site, "The position-force site behind the bend."),
                          tactus::field("soft_limit", &Params::soft_limit, "Where the bend begins.")};
    }
  };
  using Input = tactus::control::MasterInput;
  using Output = tactus::control::MasterOutput;

  static tactus::Result<SoftLimitMaster> make(const Params& params, tactus::Seconds dt) {
    if (auto error = tactus::signal::check(params, dt)) return *std::move(error);
    const auto site = tactus::control::PositionForceMaster::make(params.site, dt);
    // Not under("site", ...): a file has these keys in [control] itself.
    if (!site) return site.error();
    return SoftLimitMaster(params, *site);
  }

  /// Force and command for this tick. Real-time safe.
  Output respond(const Input& input) noexcept {
    Input bent = input;
    bent.arrival.message.force_N = bend(input.arrival.message.force_N);
    return site_.respond(bent);
  }
  /// Passes on the force after the safety gate, which drives the model of cancellation. Real-time safe.
  void applied(double motor_force_N) noexcept { site_.applied(motor_force_N); }
  /// `respond` and `applied` in one call, for use without a gate.
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  void reset() noexcept { site_.reset(); }

 private:
  // With a force gain of 0 both bounds are infinite and nothing is bent.
  SoftLimitMaster(const Params& params, const tactus::control::PositionForceMaster& site)
      : largest_N_(params.site.force_limit_N / params.site.force_gain),
        linear_N_(params.soft_limit.linear_fraction * largest_N_),
        site_(site) {}

  /// A NaN stays one, so it reaches the gate, which catches and latches it.
  [[nodiscard]] double bend(double force_N) const noexcept {
    const double magnitude_N = std::abs(force_N);
    if (magnitude_N <= linear_N_) return force_N;
    const double range_N = largest_N_ - linear_N_;
    return std::copysign(linear_N_ + range_N * std::tanh((magnitude_N - linear_N_) / range_N), force_N);
  }

  double largest_N_;
  double linear_N_;
  tactus::control::PositionForceMaster site_;
};
