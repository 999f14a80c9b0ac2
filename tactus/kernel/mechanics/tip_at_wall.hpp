// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/mechanics/cable_chain.hpp>

namespace tactus::mechanics {

/// What happened in one substep.
template <class Scalar>
struct TipContact {
  Scalar contact_force_N{};  ///< mean over the substep, positive when the wall pushes the tip back
  Scalar touched{};          ///< 1 when the tip went from a gap into the wall, else 0
  Scalar touched_after_s{};  ///< when, from the start of the substep
};

/// One substep of a chain whose tip faces a wall, cut where the tip meets or leaves the wall's surface. The instant is
/// found by false position, trying parts of the substep, and the two parts are stepped one after the other.
///
/// A template on the scalar: in a block of lanes all try when one crosses, and those that do not cross keep what the
/// whole substep gave them, so a lane never sees its neighbours. `Wall` has `position_m()` and `force_N(position_m,
/// velocity_m_per_s)`.
template <class Scalar, class Wall>
class TipAtWall {
 public:
  using Motion = CableChainMotion<Scalar>;

  /// `dt_s` is the substep that `chain` was made for. Both must stay.
  TipAtWall(Motion& chain, Wall& wall, const Scalar& dt_s) : chain_(chain), wall_(wall), dt_s_(dt_s) {}

  /// Advances by one substep under `motor_force_N`, positive toward the environment. Real-time safe.
  TipContact<Scalar> step(const Scalar& motor_force_N) noexcept {
    const State before = chain_.state;
    const Scalar force_N = advance(motor_force_N, dt_s_, chain_.step);
    const auto crossed = is_outside(before.position_m[2]) != is_outside(chain_.state.position_m[2]);
    TipContact<Scalar> contact{.contact_force_N = force_N};
    if (any(crossed)) cut(before, motor_force_N, crossed, contact);
    return contact;
  }

 private:
  using State = typename Motion::State;
  using Step = typename Motion::Step;

  [[nodiscard]] Scalar gap_m() const noexcept { return wall_.position_m() - chain_.state.position_m[2]; }
  [[nodiscard]] auto is_outside(const Scalar& tip_position_m) const noexcept {
    return wall_.position_m() - tip_position_m > 0.0;
  }

  /// Advances by part of a substep and returns the wall's force at the middle of the way.
  Scalar advance(const Scalar& motor_force_N, const Scalar& duration_s, const Step& over) noexcept {
    const Scalar velocity = chain_.state.velocity_m_per_s[2];
    const Scalar force_N = wall_.force_N(chain_.state.position_m[2] + 0.5 * duration_s * velocity, velocity);
    chain_.advance({.motor_force_N = motor_force_N, .tip_force_N = -force_N}, over);
    return force_N;
  }
  Scalar advance(const Scalar& motor_force_N, const Scalar& duration_s) noexcept {
    return advance(motor_force_N, duration_s, chain_.step_of(duration_s));
  }

  /// Takes back the substep where the tip `crossed` the surface and steps it in two parts.
  template <class Condition>
  void cut(const State& before, const Scalar& motor_force_N, const Condition& crossed,
           TipContact<Scalar>& contact) noexcept {
    const State whole = chain_.state;
    const Scalar until = crossing_time(before, motor_force_N);
    chain_.state = before;
    const Scalar before_force_N = advance(motor_force_N, until);
    const Scalar rest = dt_s_ - until;
    const Scalar after_force_N = advance(motor_force_N, rest);
    const Scalar mean_force_N = (before_force_N * until + after_force_N * rest) / dt_s_;
    contact = {
        .contact_force_N = select(crossed, mean_force_N, contact.contact_force_N),
        .touched = select(crossed, select(is_outside(before.position_m[2]), Scalar(1.0), Scalar(0.0)), Scalar(0.0)),
        .touched_after_s = select(crossed, until, Scalar(0.0))};
    chain_.state = select_state<Condition, Scalar>(crossed, chain_.state, whole);
  }

  /// Time from `before` at which the tip crosses the surface.
  Scalar crossing_time(const State& before, const Scalar& motor_force_N) noexcept {
    // Illinois variant of false position, a fixed number of rounds: the worst case is the usual case. The tip's path
    // within a substep is close to a straight line, so four rounds leave far less than a nanosecond.
    Scalar early = 0.0, late = dt_s_;
    Scalar gap_early = wall_.position_m() - before.position_m[2];
    Scalar gap_late = gap_m();
    Scalar time = 0.0;
    for (int round = 0; round < 4; ++round) {
      time = clamped<Scalar>(late - gap_late * (late - early) / (gap_late - gap_early), Scalar(0.0), dt_s_);
      chain_.state = before;
      advance(motor_force_N, time);
      const Scalar gap = gap_m();
      const auto same_side = (gap > 0.0) == (gap_late > 0.0);
      late = select(same_side, time, late);
      early = select(same_side, early, time);
      const Scalar next_late = select(same_side, gap, gap_late * 0.5);
      gap_early = select(same_side, gap_early * 0.5, gap);
      gap_late = next_late;
    }
    return time;
  }

  Motion& chain_;
  Wall& wall_;
  Scalar dt_s_;
};

}  // namespace tactus::mechanics
