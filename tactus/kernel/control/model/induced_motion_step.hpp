// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/mechanics/bouc_wen.hpp>
#include <tactus/kernel/mechanics/friction.hpp>

#include <array>
#include <cstddef>

namespace tactus::control {

/// The arithmetic of the exact step of an `InducedMotionModel`, apart from how parameters become its coefficients. A
/// template on the scalar, and made of nothing else: a sweep runs it in lanes.
template <class Scalar>
struct InducedMotionStep {
  /// The state, then the forces that would bring motor and drum to rest at the end of the tick, each on its own.
  /// Eight make whole vector registers.
  using Column = std::array<Scalar, 8>;
  using State = std::array<Scalar, 6>;

  /// What friction can still change, as bounds on its force, and the velocity offset that it acts against.
  struct FrictionRange {
    Scalar least_share, most_share;
    Scalar offset_m_per_s;
  };
  /// What acts from outside and by friction on the two masses that rub.
  struct GroundForces {
    Scalar motor_N, drum_N;
  };

  std::array<Column, 6> transition{};  ///< columns of Φ
  std::array<Column, 3> response{};    ///< columns of Γ: unit force on motor, drum, handle held over a tick
  Column offset_response{};            ///< what a unit of the friction's velocity offset adds
  Scalar motor_per_drum{};             ///< by how much a unit of friction on the drum lessens what stops the motor
  Scalar drum_per_motor{};             ///< and the other way round
  Scalar both_stopped{};               ///< 1 / (1 − the product of the two)
  Scalar dt_s{};
  Scalar motor_friction_N{}, drum_friction_N{};
  Scalar velocity_share{};  ///< of the intended velocity that friction sees: 1, or 0 for friction as at rest
  Scalar friction_band_m_per_s{};
  Scalar quintic_N_per_m5{}, quintic_guard_m{};
  Scalar linkage_stiffness_N_per_m{};  ///< initial
  mechanics::BoucWenMotion<Scalar> linkage;
  State state{};

  [[nodiscard]] FrictionRange friction_range(const Scalar& intended_velocity) const noexcept {
    // Faster than any hand; keeps the products below finite whatever the velocity.
    const Scalar fastest_m_per_s = 1e3;
    const Scalar w = velocity_share * clamped<Scalar>(intended_velocity, -fastest_m_per_s, fastest_m_per_s);
    const Scalar used = clamped<Scalar>(w / friction_band_m_per_s, Scalar(-1.0), Scalar(1.0));
    return {.least_share = used - 1.0,
            .most_share = used + 1.0,
            .offset_m_per_s = mechanics::soft_threshold(w, friction_band_m_per_s)};
  }

  [[nodiscard]] Scalar quintic_force_N(const Scalar& handle_position_m) const noexcept {
    const Scalar guarded_m = clamped<Scalar>(handle_position_m, -quintic_guard_m, quintic_guard_m);
    const Scalar squared = guarded_m * guarded_m;
    return (squared * squared) * (quintic_N_per_m5 * guarded_m);
  }

  /// What the linkage pulls with beyond its initial stiffness, in N: of the other sign.
  Scalar slipped_force_N(const Scalar& linkage_deflection_m) noexcept {
    return linkage.step(linkage_deflection_m) - linkage_stiffness_N_per_m * linkage_deflection_m;
  }

  /// Each force f is the clamp, to what friction can give, of what stops its mass while the other force acts. Put one
  /// into the other: what stops the motor is a line in the motor's own force, of a slope below one, clamped because the
  /// drum's force is. The fixed point of a clamped line is the fixed point of the line, which stops both masses,
  /// clamped alike.
  ///
  /// On the motor the sum of motor force and friction is found so, and not friction alone: what stops a mass at rest is
  /// then zero exactly, and not the motor force to rounding.
  [[nodiscard]] GroundForces ground_forces(const Scalar& motor_force_N, const Scalar& stops_motor_N,
                                           const Scalar& stops_drum_N, const FrictionRange& range) const noexcept {
    using std::max;
    using std::min;
    struct Bounds {
      Scalar least_N, most_N;
    };
    const auto bounds = [&range](const Scalar& force_N, const Scalar& friction_N) {
      return Bounds{force_N + friction_N * range.least_share, force_N + friction_N * range.most_share};
    };
    const auto force = [](const Scalar& stops_both_N, const Scalar& stops_alone_N, const Scalar& per_other,
                          const Bounds& own, const Bounds& other) {
      const Scalar a = per_other * other.least_N, b = per_other * other.most_N;
      const Scalar coupled = clamped<Scalar>(stops_both_N, stops_alone_N - max(a, b), stops_alone_N - min(a, b));
      // In this order, unlike in a clamp, a motor force that is not a number comes out as it went in.
      return min(max(own.least_N, coupled), own.most_N);
    };
    const Bounds motor = bounds(motor_force_N, motor_friction_N), drum = bounds(Scalar(0.0), drum_friction_N);
    const Scalar motor_of_both_N = both_stopped * stops_motor_N - (both_stopped * motor_per_drum) * stops_drum_N;
    const Scalar drum_of_both_N = both_stopped * stops_drum_N - (both_stopped * drum_per_motor) * stops_motor_N;
    return {.motor_N = force(motor_of_both_N, stops_motor_N, motor_per_drum, motor, drum),
            .drum_N = force(drum_of_both_N, stops_drum_N, drum_per_motor, drum, motor)};
  }

  /// By how much hand and linkage differ from those of `transition`.
  struct Difference {
    Scalar hand_stiffness_N_per_m{}, hand_damping_N_s_per_m{};
    Scalar linkage_share{};  ///< of the linkage's force, to add to it
    Scalar yielding{};       ///< `yielding_of` the damping
  };

  /// By which share more damping of the hand lessens its own force, because the handle slows down within the tick.
  [[nodiscard]] Scalar yielding_of(const Scalar& hand_damping_N_s_per_m) const noexcept {
    return 1.0 / (1.0 + 0.5 * hand_damping_N_s_per_m * response[2][5]);
  }

  /// One tick with the forces on motor and handle held. `hysteretic`: whether the linkage is, in any lane.
  void advance(const Scalar& motor_force_N, const Scalar& handle_force_N, const FrictionRange& range,
               bool hysteretic) noexcept {
    // The nonlinear forces where the masses will be in the middle of the tick: half a tick of lag would cost an order.
    const Scalar quintic_N = quintic_force_N(state[2] + 0.5 * dt_s * state[5]);
    const Scalar slipped_N = hysteretic ? slipped_force_N(stretch_in_the_middle(state)) : Scalar(0.0);
    rub(motor_force_N, coast(state, slipped_N - quintic_N + handle_force_N, slipped_N, range.offset_m_per_s), range);
  }

  /// The same tick with another hand, without the quintic spring. Returns the linkage's force in N, without its share.
  Scalar advance_in_another_hand(const Difference& other, const Scalar& motor_force_N, const FrictionRange& range,
                                 bool hysteretic) noexcept {
    const Scalar stretch_m = stretch_in_the_middle(state);
    const Scalar slipped_N = hysteretic ? slipped_force_N(stretch_m) : Scalar(0.0);
    const Scalar linkage_N = slipped_N + linkage_stiffness_N_per_m * stretch_m;
    const Scalar beyond_N = slipped_N + other.linkage_share * linkage_N;
    const Held held = held_by(other, state);
    Column next = coast(state, beyond_N, beyond_N, range.offset_m_per_s);
    const Scalar held_N = held.at_rest_N - held.damping_N_s_per_m * next[5];
    for (std::size_t row = 0; row < next.size(); ++row) next[row] = next[row] + response[2][row] * held_N;
    rub(motor_force_N, next, range);
    return linkage_N;
  }

  /// What a small change of two parameters adds to the forces, one of the hand and one of the linkage, in N, and how
  /// far the linkage's average stiffness is below the initial one.
  struct Added {
    Scalar hand_N;  ///< times `Difference::yielding`
    Scalar linkage_N;
    Scalar softer_N_per_m;
  };
  /// A tick of what these changes do to the state, for each unit of change: linear, without friction, the linkage at
  /// its average stiffness. Both at once, so that each coefficient is fetched once.
  void advance_tangents(State& of_hand, State& of_linkage, const Difference& other, const Added& added) const noexcept {
    const Scalar hand_beyond_N = -added.softer_N_per_m * stretch_in_the_middle(of_hand);
    const Scalar linkage_beyond_N = added.linkage_N - added.softer_N_per_m * stretch_in_the_middle(of_linkage);
    const auto coasted = [this](std::size_t row, const State& from) {
      const Scalar positions =
          transition[0][row] * from[0] + transition[1][row] * from[1] + transition[2][row] * from[2];
      const Scalar velocities =
          transition[3][row] * from[3] + transition[4][row] * from[4] + transition[5][row] * from[5];
      return positions + velocities;
    };
    State hand, linkage_state;
    for (std::size_t row = 0; row < hand.size(); ++row) {
      const Scalar apart = response[2][row] - response[1][row];
      hand[row] = coasted(row, of_hand) + apart * hand_beyond_N;
      linkage_state[row] = coasted(row, of_linkage) + apart * linkage_beyond_N;
    }
    const Held held = held_by(other, of_hand), linkage_held = held_by(other, of_linkage);
    const Scalar on_hand_N = (held.at_rest_N - held.damping_N_s_per_m * hand[5]) + added.hand_N;
    const Scalar on_linkage_N = linkage_held.at_rest_N - linkage_held.damping_N_s_per_m * linkage_state[5];
    for (std::size_t row = 0; row < hand.size(); ++row) {
      of_hand[row] = hand[row] + response[2][row] * on_hand_N;
      of_linkage[row] = linkage_state[row] + response[2][row] * on_linkage_N;
    }
  }

 private:
  [[nodiscard]] Scalar stretch_in_the_middle(const State& from) const noexcept {
    return from[1] - from[2] + 0.5 * dt_s * (from[4] - from[5]);
  }

  /// The end of a tick without forces on motor and drum from outside.
  [[nodiscard]] Column coast(const State& from, const Scalar& on_handle_N, const Scalar& slipped_N,
                             const Scalar& offset_m_per_s) const noexcept {
    // The sum is in the order in which its terms become known, so that few of them are waited for.
    Column next;
    for (std::size_t row = 0; row < next.size(); ++row) {
      const Scalar offset = offset_response[row] * offset_m_per_s;
      const Scalar positions =
          transition[0][row] * from[0] + transition[1][row] * from[1] + transition[2][row] * from[2];
      const Scalar velocities =
          transition[3][row] * from[3] + transition[4][row] * from[4] + transition[5][row] * from[5];
      next[row] = (offset + (positions + velocities)) + response[2][row] * on_handle_N - response[1][row] * slipped_N;
    }
    return next;
  }

  /// What another hand pushes with more, as a line in the velocity that the handle would have at the end of the tick
  /// without it: its damping acts on the mean velocity of the tick, which makes it stable whatever its size.
  struct Held {
    Scalar at_rest_N, damping_N_s_per_m;
  };
  [[nodiscard]] Held held_by(const Difference& other, const State& from) const noexcept {
    const Scalar damping = 0.5 * other.hand_damping_N_s_per_m * other.yielding;
    const Scalar stiffness = other.hand_stiffness_N_per_m * other.yielding;
    return {.at_rest_N = -(stiffness * (from[2] + 0.5 * dt_s * from[5]) + damping * from[5]),
            .damping_N_s_per_m = damping};
  }

  void rub(const Scalar& motor_force_N, const Column& next, const FrictionRange& range) noexcept {
    const GroundForces ground = ground_forces(motor_force_N, next[6], next[7], range);
    for (std::size_t row = 0; row < state.size(); ++row) {
      state[row] = next[row] + (response[0][row] * ground.motor_N + response[1][row] * ground.drum_N);
    }
  }
};

}  // namespace tactus::control
