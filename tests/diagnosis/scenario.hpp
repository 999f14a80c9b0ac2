// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "tests/diagnosis/known_cause.hpp"
#include "tests/diagnosis/sticking_carriage.hpp"

/// What is simulated for a recording: a rig, a person at it, and the run.
namespace tactus::known {

inline constexpr double duration_s = 10.0;
inline constexpr double held_from_s = 3.5;  ///< until then the person moves about

/// The slave's servo with an integral of the error: what hunts about a place where friction holds it.
struct IntegralParams {
  double integral_N_per_m_s = 0.0;
  static constexpr auto fields() {
    return List{field("integral_N_per_m_s", &IntegralParams::integral_N_per_m_s, units::none, between(0.0, 1e6),
                      "Force per integral of the position error, in N/(m s).")};
  }
};

/// Makes the architecture `integral` known: position-force whose slave integrates the error.
void register_integral();

/// Where the person wants the hand: reaches one after the other, rests between, and a tremor whose size wanders.
class Path {
 public:
  void reach(double to_m, double speed_m_per_s, double rest_s) {
    const double stroke_m = std::abs(to_m - at_m_);
    if (stroke_m > 0.0) {
      const double takes_s = mechanics::MinimumJerk::duration_for(stroke_m, speed_m_per_s);
      reaches_.push_back({.start_m = at_m_, .end_m = to_m, .start_time_s = until_s_, .duration_s = takes_s});
      until_s_ += takes_s;
    }
    at_m_ = to_m;
    until_s_ += rest_s;
  }
  void glide(double to_m, double speed_m_per_s) {
    glides_.push_back({until_s_, at_m_, to_m, std::abs(to_m - at_m_) / speed_m_per_s});
    until_s_ += glides_.back().takes_s;
    at_m_ = to_m;
  }
  void start_at(double start_m) { at_m_ = start_m_ = start_m; }
  void rest_until(double time_s) { until_s_ = std::max(until_s_, time_s); }
  [[nodiscard]] double until_s() const { return until_s_; }
  [[nodiscard]] double start_m() const { return start_m_; }
  [[nodiscard]] double at(double time_s) const {
    double position_m = start_m_;
    for (const auto& reach : reaches_) position_m += reach.position_m(time_s) - reach.start_m;
    for (const Glide& glide : glides_) {
      position_m += (glide.to_m - glide.from_m) * std::clamp((time_s - glide.begins_s) / glide.takes_s, 0.0, 1.0);
    }
    return position_m;
  }

 private:
  struct Glide {
    double begins_s, from_m, to_m, takes_s;
  };
  std::vector<mechanics::MinimumJerk> reaches_;
  std::vector<Glide> glides_;
  double start_m_ = 0.0, at_m_ = 0.0, until_s_ = 0.3;
};
struct Scenario {
  simulation::Teleoperator::Params rig;
  Path path;
  std::optional<StickingCarriage::Params> carriage;
  double tremor_Hz = 9.0;
  double tremor_rms_m = 1e-5;
  std::uint64_t seed = 0;
};

/// What was recorded, and how often the slave turned back and forth in the last three seconds, seen at every tick: what
/// is too fast for 1 kHz is left out.
struct Run {
  std::vector<Row> rows;
  double turns_Hz = 0.0;
};

/// Errors: of what is out of bounds, and of a safety gate that let go.
Result<Run> simulate(const Scenario& scenario);

}  // namespace tactus::known
