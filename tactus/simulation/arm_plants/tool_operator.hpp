// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/hand.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/environment.hpp>
#include <tactus/kernel/signal/low_pass.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tactus::arm_plants {

/// A smooth plane that the tool meets: it pushes along its normal by what the law of one axis states of the depth and
/// of the speed into it. Real-time safe.
struct Wall {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();  ///< out of it, of length 1
  mechanics::Environment contact;     ///< along the depth, its surface at 0

  [[nodiscard]] Vector3 force_N(const ToolState& tool) noexcept {
    const double push_N = contact.step(
        {.position_m = normal.dot(point_m - tool.position_m), .velocity_m_per_s = -normal.dot(tool.velocity_m_per_s)});
    return push_N == 0.0 ? Vector3(Vector3::Zero()) : Vector3(push_N * normal);
  }
};

/// The operator who holds the leader's tool: a hand (`arm::HandImpedance`, whose mass the arm carries) that follows an
/// intended path, and slow correction. The operator sees or feels the tool off the path and shifts the aim, as an
/// integrator on the error, low-passed near 5 Hz and a reaction time late. On the path lies physiological tremor, the
/// same along each axis of the base and a third of a cycle apart. The attitude is held where it was at first. What one
/// axis has in `mechanics::Operator`, in three.
class ToolOperator {
 public:
  struct Params {
    arm::HandImpedance hand = {};
    double correction_gain_per_s = 4.0;
    double correction_bandwidth_Hz = 5.0;
    double reaction_time_s = 0.1;
    double tremor_amplitude_m = 0.0;
    double tremor_frequency_Hz = 10.0;
    static constexpr auto fields() {
      return List{
          field("hand", &Params::hand, "The passive impedance of hand and arm at the tool."),
          field("correction_gain_per_s", &Params::correction_gain_per_s, units::per_second, between(0.0, 8.0),
                "Speed of the operator's slow correction per metre of error of the tool's position; 0: no correction."),
          field("correction_bandwidth_Hz", &Params::correction_bandwidth_Hz, units::hertz, between(0.1, 20.0),
                "Corner frequency of the first-order low-pass on the position error that the operator corrects."),
          field("reaction_time_s", &Params::reaction_time_s, units::second, between(0.0, 0.4),
                "Time from an error to the start of its correction."),
          field("tremor_amplitude_m", &Params::tremor_amplitude_m, units::metre, between(0.0, 0.005),
                "Amplitude of physiological tremor on the intended path, along each axis."),
          field("tremor_frequency_Hz", &Params::tremor_frequency_Hz, units::hertz, between(1.0, 30.0),
                "Frequency of the tremor.")};
    }
  };

  /// Who holds a tool that is there, at rest, and wants it there. `tick_s` is the time between calls of `begin_tick`.
  static Result<ToolOperator> make(const Params& params, Seconds tick, const ToolState& tool);

  /// Once a tick: where the hand wants the tool now and a tick later, and where it is.
  void begin_tick(const Vector3& path_m, const Vector3& path_at_next_tick_m, const ToolState& tool);
  /// Holds on with the spring and the damper of `other`, which gets the own ones: its mass is carried elsewhere.
  void exchange_hand(ToolOperator& other) noexcept { std::swap(hand_, other.hand_); }
  /// What the hand does to the tool `since_tick_s` after the tick began.
  [[nodiscard]] ToolForce force(const ToolState& tool, double since_tick_s) const;

 private:
  ToolOperator(const Params& params, Seconds tick, const ToolState& tool, const signal::LowPass& low_pass);
  [[nodiscard]] Vector3 tremor_m(std::int64_t tick) const;

  arm::HandImpedance hand_;
  double correction_gain_per_s_;
  double tremor_amplitude_m_;
  double tremor_frequency_Hz_;
  double tick_s_;
  std::int64_t tick_ = 0;
  arm::Matrix3 attitude_;
  std::array<signal::LowPass, 3> low_pass_;
  std::vector<Vector3> felt_m_;  ///< a ring, as long as the reaction takes
  std::size_t next_ = 0;
  Vector3 correction_m_ = Vector3::Zero();
  Vector3 aim_m_;
  Vector3 aim_m_per_s_ = Vector3::Zero();
};

}  // namespace tactus::arm_plants
