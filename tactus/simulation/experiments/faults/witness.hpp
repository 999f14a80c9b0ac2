// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/control/supervision.hpp>
#include <tactus/simulation/experiments/faults/outcome.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace tactus::experiments {

/// Watches the force at one motor. It knows the limits from the file and nothing of the gate.
class ForceWitness {
 public:
  /// A stop may be faster than the rate limit: a force may fall to zero, and not beyond, as fast as the largest one
  /// does within `stop_time_s`.
  ForceWitness(double limit_N, double rate_N_per_s, double stop_time_s, double tick_s)
      : limit_N_(limit_N),
        most_N_(rate_N_per_s * tick_s),
        most_fall_N_(std::max(most_N_, limit_N / stop_time_s * tick_s)) {}

  /// The force of this tick; `excused` where a process just died or started, which no gate can smooth.
  void see(double force_N, bool excused, FaultOutcome& outcome) {
    if (!std::isfinite(force_N)) {
      ++outcome.not_finite;
      return;
    }
    step_N_ = excused ? 0.0 : std::fabs(force_N - before_N_);
    // A difference of two sums of steps: the last digits of the largest force.
    const bool falls = std::fabs(force_N) <= std::fabs(before_N_) && force_N * before_N_ >= 0.0;
    if (step_N_ > (falls ? most_fall_N_ : most_N_) + 1e-12 * limit_N_) ++outcome.steps_above_rate;
    if (std::fabs(force_N) > limit_N_) ++outcome.forces_above_limit;
    outcome.peak_force_N = std::max(outcome.peak_force_N, std::fabs(force_N));
    before_N_ = force_N;
  }
  [[nodiscard]] double step_N() const { return step_N_; }

 private:
  double limit_N_;
  double most_N_;
  double most_fall_N_;
  double before_N_ = 0.0;
  double step_N_ = 0.0;
};

/// Watches what one site applies of the packets of the other: remembers when each was sent.
class PacketWitness {
 public:
  explicit PacketWitness(double longest_age_s, double tick_s)
      : longest_ticks_(static_cast<std::int64_t>(longest_age_s / tick_s) + 1) {}

  /// Makes room for so many sessions of as many packets; before the first. What follows allocates only beyond them.
  void expect(std::size_t sessions, std::int64_t packets) {
    starts_.resize(sessions);
    for (Session& one : starts_) one.ticks.reserve(static_cast<std::size_t>(packets));
  }
  template <class Payload = control::Message>
  void sent(const control::PacketOf<Payload>& packet, std::int64_t tick) {
    if (packet.session != session_) {
      session_ = packet.session;
      if (begun_ == starts_.size()) starts_.emplace_back();
      starts_[begun_++].session = packet.session;
    }
    starts_[begun_ - 1].ticks.push_back(tick);
  }
  void applied(const control::SiteRecord& record, std::int64_t tick, FaultOutcome& outcome) {
    if (!record.fresh) return;
    const std::int64_t sent_tick = find(record.applied_session, record.applied_sequence);
    if (sent_tick <= newest_ || tick - sent_tick > longest_ticks_) ++outcome.stale_applied;
    newest_ = std::max(newest_, sent_tick);
  }
  /// The receiver restarts, and with it what it may apply.
  void restart() { newest_ = -1; }

 private:
  struct Session {
    std::int64_t session = 0;
    std::vector<std::int64_t> ticks;  ///< of each sequence number, from 1
  };
  [[nodiscard]] std::int64_t find(std::int64_t session, std::int64_t sequence) const {
    for (const Session& one : starts_) {
      const bool there = sequence >= 1 && static_cast<std::size_t>(sequence) <= one.ticks.size();
      if (one.session == session && there) return one.ticks[static_cast<std::size_t>(sequence) - 1];
    }
    return -1;  // applied what nobody sent
  }

  std::int64_t longest_ticks_;
  std::int64_t session_ = 0;
  std::size_t begun_ = 0;  ///< sessions
  std::int64_t newest_ = -1;
  std::vector<Session> starts_;
};

/// Counts the energy that a motor really gave, from its true position, and its largest rise.
class EnergyWitness {
 public:
  /// `force_N` acts from now on, `position_m` is the true one of the motor now. Returns the largest rise so far in J.
  double see(double force_N, double position_m) {
    const double work_J = force_N_ * (position_m - before_m_);
    force_N_ = force_N;
    before_m_ = position_m;
    return add(work_J);
  }
  /// The same of work in J that was done since the tick before.
  double add(double work_J) {
    given_J_ += work_J;
    least_J_ = std::min(least_J_, given_J_);
    return rise_J_ = std::max(rise_J_, given_J_ - least_J_);
  }

 private:
  double force_N_ = 0.0;
  double before_m_ = 0.0;
  double given_J_ = 0.0;
  double least_J_ = 0.0;
  double rise_J_ = 0.0;
};

/// What is true at a site at a tick, whatever its sensors report. Positions and forces are positive toward the
/// environment.
struct SiteTruth {
  double drive_N = 0.0;  ///< what the motor is made to give from now on
  double motor_m = 0.0;
  double motor_m_per_s = 0.0;
  double tip_m = 0.0;  ///< handle or tool
  double tip_m_per_s = 0.0;
  double outside_N = 0.0;  ///< hand on handle or wall on tool
  /// Work in J since the tick before on whoever touches it, where that is no force times a way: of an arm, whose motors
  /// lift its own weight too.
  std::optional<double> worked_J = std::nullopt;

  /// Enters it, and returns the largest rise so far in J.
  double enter(EnergyWitness& energy) const { return worked_J ? energy.add(*worked_J) : energy.see(drive_N, motor_m); }
};

/// A low-pass of first order, for what lasts.
class Lasting {
 public:
  Lasting(double time_constant_s, double tick_s) : share_(1.0 - std::exp(-tick_s / time_constant_s)) {}
  double see(double value) { return value_ += share_ * (value - value_); }

 private:
  double share_;
  double value_ = 0.0;
};

/// Measures what a fault does to the operator and to what the slave touches, from its first tick on.
class HarmWitness {
 public:
  /// `range_m` is how far to either side of `middle_m` the operator leads the tip, `released_N` a force that counts as
  /// zero.
  HarmWitness(double middle_m, double range_m, double released_N, double tick_s)
      : middle_m_(middle_m), range_m_(range_m), released_N_(released_N), pressing_(0.1, tick_s) {}

  void see(const SiteTruth& truth, double now_s, SiteHarm& harm) {
    harm.given_J = truth.enter(energy_);
    harm.speed_m_per_s = std::max(harm.speed_m_per_s, std::fabs(truth.tip_m_per_s));
    harm.strayed_m = std::max(harm.strayed_m, std::fabs(truth.tip_m - middle_m_) - range_m_);
    harm.peak_force_N = std::max(harm.peak_force_N, std::fabs(truth.outside_N));
    harm.pressing_N = std::max(harm.pressing_N, std::fabs(pressing_.see(truth.outside_N)));
    if (started_) harm.drive_step_N = std::max(harm.drive_step_N, std::fabs(truth.drive_N - before_N_));
    started_ = true;
    before_N_ = truth.drive_N;
    if (std::fabs(truth.drive_N) > released_N_ && !brakes(truth)) forced_s_ = now_s;
  }
  /// When the motor pushed or pressed last.
  [[nodiscard]] double forced_s() const { return forced_s_; }

 private:
  /// A force against the motion, as that of the damper which a passivity monitor leaves on: it takes energy from who
  /// moves the device, and ends with the motion. What only presses is at rest and does not count, what pushes goes
  /// along.
  static bool brakes(const SiteTruth& truth) {
    return std::fabs(truth.motor_m_per_s) > at_rest_m_per_s && truth.drive_N * truth.motor_m_per_s < 0.0;
  }
  static constexpr double at_rest_m_per_s = 0.01;

  EnergyWitness energy_;
  double middle_m_;
  double range_m_;
  double released_N_;
  Lasting pressing_;
  bool started_ = false;
  double before_N_ = 0.0;
  double forced_s_ = 0.0;
};

}  // namespace tactus::experiments
