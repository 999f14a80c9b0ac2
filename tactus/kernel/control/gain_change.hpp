// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>

namespace tactus::control {

/// The force gain of a site that runs, on its way to what the operator asked for: it changes by no more than a rate, so
/// a displayed force F changes by |F|·rate/gain at most and never in a step, and it never exceeds a limit, whatever is
/// asked. A controller without a force gain has nothing to change.
class GainChange {
 public:
  struct Params {
    double limit = 0.0;
    double rate_per_s = 1.0;
    static constexpr auto fields() {
      return List{
          field("limit", &Params::limit, units::none, between(0.0, 1000.0),
                "Largest force gain that an operator may set while the site runs; 0: the force gain of the file."),
          field("rate_per_s", &Params::rate_per_s, units::per_second, positive_up_to(100.0),
                "Largest rate of change of the force gain after an operator sets it.")};
    }
  };
  struct Input {
    double asked = -1.0;  ///< the gain that is asked for; below 0 or NaN: what was asked last
    std::int64_t elapsed_ticks = 1;
  };
  /// The gain for this tick, if it is another than at the tick before.
  using Output = std::optional<double>;

  /// `start` is the gain of the controller; nullopt without one. Errors: out of bounds; `inconsistent` for a limit
  /// below `start`, or where there is no gain to limit.
  static Result<GainChange> make(const Params& params, std::optional<double> start, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    if (params.limit > 0.0 && (!start || params.limit < *start)) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "limit",
                   .message = start ? rounded_number(params.limit) + " is below the force gain of the file, " +
                                          rounded_number(*start) + ": write at least that, or 0 for that"
                                    : "the controller has no force gain that can change while it runs: write 0",
                   .place = {}};
    }
    return GainChange(start.value_or(-1.0), params.limit, params.rate_per_s * dt.value);
  }

  /// Real-time safe.
  Output step(const Input& input) noexcept {
    if (!changes()) return std::nullopt;
    if (input.asked >= 0.0) wanted_ = std::min(input.asked, limit_);
    if (wanted_ == gain_) return std::nullopt;
    // After a stall it goes no farther than in one tick.
    gain_ = wanted_ > gain_ ? std::min(wanted_, gain_ + step_) : std::max(wanted_, gain_ - step_);
    return gain_;
  }

  /// Whether there is a gain that can change.
  [[nodiscard]] bool changes() const noexcept { return gain_ >= 0.0; }
  /// At the latest tick; 0 without such a gain.
  [[nodiscard]] double gain() const noexcept { return std::max(gain_, 0.0); }
  [[nodiscard]] double limit() const noexcept { return limit_; }

 private:
  GainChange(double gain, double limit, double step)
      : gain_(gain), wanted_(gain), limit_(limit > 0.0 ? limit : std::max(gain, 0.0)), step_(step) {}

  double gain_;
  double wanted_;
  double limit_;
  double step_;  ///< in a tick
};

}  // namespace tactus::control
