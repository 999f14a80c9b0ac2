// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/real_time/emulated_arm.hpp>

#include <optional>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

/// What an emulated arm touches, and who taps with it: `--wall` and `--tapped` of a command.
struct TouchOptions {
  std::optional<double> wall_m;
  std::vector<double> tapped;

  [[nodiscard]] std::optional<real_time::EmulatedArm::Surface> surface() const {
    if (!wall_m) return std::nullopt;
    return real_time::EmulatedArm::Surface{.gap_m = *wall_m};
  }
  [[nodiscard]] std::optional<real_time::EmulatedArm::Tapping> tapping() const {
    if (tapped.empty()) return std::nullopt;
    return real_time::EmulatedArm::Tapping{.depth_m = tapped[0], .period_s = tapped[1], .after_s = tapped[2]};
  }
  /// Errors: `out_of_bounds` for a depth or a period that no hand taps.
  [[nodiscard]] Check check() const {
    if (tapped.empty()) return std::nullopt;
    constexpr Bounds depths = between(0.0, 0.2), periods = between(0.5, 60.0);
    Check wrong;
    if (!depths.contain(tapped[0])) {
      wrong = out_of_bounds("DEPTH", tapped[0], depths, units::metre);
    } else if (!periods.contain(tapped[1])) {
      wrong = out_of_bounds("PERIOD", tapped[1], periods, units::second);
    }
    if (wrong) wrong->place = "--tapped";
    return wrong;
  }
};

/// `wall` and `tapped` are their help.
struct TouchOptionsOf {
  CLI::Option *wall, *tapped;
};
inline TouchOptionsOf add_touch_options(CLI::App& verb, TouchOptions& options, const char* wall, const char* tapped) {
  constexpr double farthest_m = 1.0, most = 1000.0;
  return {
      .wall = verb.add_option("--wall", options.wall_m, wall)->type_name("GAP")->check(real_between(0.0, farthest_m)),
      .tapped = verb.add_option("--tapped", options.tapped, tapped)
                    ->type_name("DEPTH,PERIOD,SECONDS")
                    ->delimiter(',')
                    ->expected(3)
                    ->check(real_between(0.0, most))};
}

}  // namespace tactus::cli
