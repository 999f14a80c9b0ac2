// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/support_check.hpp>
#include <tactus/kernel/core/joints.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tactus::control {

/// Why the support of a device was refused or taken back, and at which joint.
struct SupportFinding {
  SupportFault fault = SupportFault::none;
  std::size_t joint = 0;
  double share = 0.0;          ///< of the support that had come in
  double moved_m = 0.0;        ///< since it began to come in; rad of a joint that turns, as below
  double speed_m_per_s = 0.0;  ///< then
  double excess_N = 0.0;       ///< what the holding law resisted
  double weight_N = 0.0;       ///< by the model, at that pose
  double limit_N = 0.0;        ///< what the motor may give
};

/// The support of a device as it comes in: its share, the holding law of each joint meanwhile (`SupportCheck`) and what
/// the joints' motion states of it. Joints are judged until all of it has come in, `settles_s` have passed and the
/// motors were tried. Then the law yields as friction does, until the coupling takes its place.
template <class Payload>
class SupportRaiseOf {
 public:
  using Checks = Each<Payload, SupportCheck>;
  using Params = Each<Payload, SupportCheck::Params>;
  using Numbers = Each<Payload, double>;

  static constexpr double settles_s = 1.0;

  /// What a site knows of its joints at a tick.
  struct Snapshot {
    Numbers position_m, velocity_m_per_s;
    Numbers weight_N;      ///< of the tick before, all of it
    bool carried = false;  ///< by something
    bool seen = false;     ///< every joint was read
    bool tried = false;    ///< a motor is tried
    bool proved = false;   ///< all were, or none is
    std::int64_t elapsed_ticks = 1;
  };

  /// `blend_s` is how long the support of a device takes that is not judged. Errors: those of `SupportCheck`.
  static Result<SupportRaiseOf> make(const Params& params, double blend_s, Seconds dt) {
    const auto checks = make_each<SupportCheck>(params, dt);
    if (!checks) return checks.error();
    return SupportRaiseOf(*checks, blend_s, dt);
  }

  /// Judges what was read, before the state is decided. Real-time safe, as all below.
  void look(const Snapshot& snapshot) noexcept {
    judged_ = judges_ && snapshot.carried;
    too_heavy_ = failed_ = false;
    if (!judged_ || !snapshot.seen) return;
    const bool counts = share_ < 1.0 || full_s_ < settles_s || snapshot.tried || !snapshot.proved;
    const bool begins = holding_ && snapshot.tried && !tried_, ends = holding_ && !snapshot.tried && tried_;
    for_each_joint(
        [&](SupportCheck& check, double at_m) noexcept {
          if (begins) check.begin_trial(at_m);
          if (ends) check.end_trial(at_m);
          if (counts && !counts_) check.count_from(at_m);
        },
        checks_, snapshot.position_m);
    tried_ = snapshot.tried;
    counts_ = counts;
    if (share_ == 1.0) full_s_ += dt_s_ * static_cast<double>(std::max<std::int64_t>(snapshot.elapsed_ticks, 1));
    std::size_t joint = 0;
    for_each_joint(
        [&](SupportCheck& check, double position_m, double velocity_m_per_s, double weight_N) noexcept {
          const std::size_t at = joint++;
          if (share_ == 0.0 && !too_heavy_ && !(std::fabs(weight_N) <= check.params().weight_limit_N)) {
            too_heavy_ = true;
            found_ = finding(check, SupportFault::weight, at, weight_N);
          }
          if (!holding_ || !check.judges()) return;
          const SupportFault fault = check.step({.position_m = position_m,
                                                 .velocity_m_per_s = velocity_m_per_s,
                                                 .weight_N = weight_N,
                                                 .share = share_,
                                                 .rises = rises(),
                                                 .judged = counts,
                                                 .tried = snapshot.tried,
                                                 .elapsed_ticks = snapshot.elapsed_ticks});
          if (fault == SupportFault::none || failed_) return;
          failed_ = true;
          found_ = finding(check, fault, at, weight_N);
        },
        checks_, snapshot.position_m, snapshot.velocity_m_per_s, snapshot.weight_N);
  }
  /// Whether a joint moved as no right support moves it, at the latest reading.
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  /// Whether nothing of the support has come in, and the model's weight of a joint exceeds what its motor may give.
  [[nodiscard]] bool too_heavy() const noexcept { return too_heavy_; }
  [[nodiscard]] const SupportFinding& found() const noexcept { return found_; }

  /// The share for this tick; `wanted`: the device has power. `at_m` is where its joints are.
  double step(bool wanted, bool lets_go, const Numbers& at_m, std::int64_t elapsed_ticks) noexcept {
    if (lets_go) {
      holding_ = false;
      return share_ = 0.0;
    }
    if (!wanted) return fall(blend_step_ * static_cast<double>(elapsed_ticks));
    if (share_ < 1.0 && judged_ && !holding_) begin(at_m);
    return share_ = std::min(share_ + (judged_ ? raise_step_ : blend_step_), 1.0);
  }
  /// Share of the holding law, where `coupling` is that of what takes its place.
  double hold(double coupling) noexcept {
    if (!holding_) return 0.0;
    held_ = std::min(held_, 1.0 - coupling);
    if (held_ == 0.0) holding_ = false;
    return held_;
  }
  [[nodiscard]] const Checks& checks() const noexcept { return checks_; }
  [[nodiscard]] double share() const noexcept { return share_; }
  /// Whether the joints are held.
  [[nodiscard]] bool holds() const noexcept { return holding_; }
  /// Whether they are held and judged.
  [[nodiscard]] bool rises() const noexcept { return holding_ && (share_ < 1.0 || full_s_ < settles_s); }

 private:
  SupportRaiseOf(const Checks& checks, double blend_s, Seconds dt)
      : checks_(checks), dt_s_(dt.value), blend_step_(dt.value / blend_s) {
    double raise_s = 0.0;
    for_each_joint([&raise_s](const SupportCheck& check) { raise_s = std::max(raise_s, check.params().raise_s); },
                   checks_);
    judges_ = raise_s > 0.0;
    if (judges_) raise_step_ = dt.value / raise_s;
  }
  void begin(const Numbers& at_m) noexcept {
    holding_ = true;
    held_ = 1.0;
    full_s_ = 0.0;
    tried_ = false;
    counts_ = true;
    found_ = {};
    for_each_joint([](SupportCheck& check, double position_m) noexcept { check.begin(position_m); }, checks_, at_m);
  }
  double fall(double step) noexcept {
    holding_ = false;
    return share_ = std::max(share_ - step, 0.0);
  }
  [[nodiscard]] SupportFinding finding(const SupportCheck& check, SupportFault fault, std::size_t joint,
                                       double weight_N) const noexcept {
    return {.fault = fault,
            .joint = joint,
            .share = share_,
            .moved_m = holding_ ? check.moved_m() : 0.0,
            .speed_m_per_s = holding_ ? check.speed_m_per_s() : 0.0,
            .excess_N = holding_ ? check.excess_N() : 0.0,
            .weight_N = weight_N,
            .limit_N = check.params().weight_limit_N};
  }

  Checks checks_;
  double dt_s_;
  double blend_step_;
  double raise_step_ = 0.0;
  bool judges_ = false;  ///< asked for
  bool judged_ = false;  ///< and something carries the device
  bool holding_ = false;
  bool tried_ = false;
  bool counts_ = false;
  bool failed_ = false;
  bool too_heavy_ = false;
  double share_ = 0.0;
  double held_ = 0.0;
  double full_s_ = 0.0;  ///< since all has come in
  SupportFinding found_;
};

}  // namespace tactus::control
