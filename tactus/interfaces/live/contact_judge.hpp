// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <cstdint>
#include <string>

namespace tactus::live {

/// What a loop is doing at its wall.
enum class LiveVerdict { free, contact, settled, rings };

/// Judges contacts while they happen, by the measure of the tapping experiment (`experiments::judge_contact`): the
/// contact force above 15 Hz, from the first touch on, must fall below a tenth of its peak and stay there.
///
/// A contact begins with a touch, and ends when nothing was touched for 0.25 s, or 0.1 s once it has settled; then the
/// verdict is `free`. `settled` once the force has been that small for 50 ms, on the wall, and fell there within 100 ms
/// of the touch, the limit of the experiment; `rings` where it did not. What rings and has been calm for half a second
/// is settled again; what is settled and becomes loud again is judged again from there. A contact too gentle to feel,
/// below 10 mN, counts as calm; once it has settled, 30 mN, for the
/// hand that presses on moves too.
class ContactJudge {
 public:
  static Result<ContactJudge> make(Seconds dt);

  /// One tick: the mean contact force in N, and whether the tip met the wall in it.
  void step(double contact_force_N, bool touched);
  void reset();
  /// The loop is another from now on: what continues at the wall is a new contact.
  void judge_anew() { anew_ = verdict_ != LiveVerdict::free; }

  [[nodiscard]] LiveVerdict verdict() const { return verdict_; }
  [[nodiscard]] bool in_contact() const { return in_contact_; }
  /// True in the first tick of a contact.
  [[nodiscard]] bool has_begun() const { return has_begun_; }
  /// From the touch, or from what began again, to the last time that the force was loud.
  [[nodiscard]] double settling_time_s() const { return static_cast<double>(loud_until_ - onset_) * dt_s_; }
  /// Why, in one sentence; empty while there is nothing to report.
  [[nodiscard]] std::string cause() const;

 private:
  ContactJudge(const signal::SecondOrderFilter& high_pass, Seconds dt) : high_pass_(high_pass), dt_s_(dt.value) {}
  [[nodiscard]] bool after(std::int64_t tick, double duration_s) const;

  signal::SecondOrderFilter high_pass_;
  double dt_s_;
  std::int64_t tick_ = 0;
  std::int64_t onset_ = 0;
  std::int64_t loud_until_ = 0;  ///< the tick after the last loud one
  std::int64_t touched_last_ = -1;
  double peak_N_ = 0.0;
  double floor_N_ = 0.0;  ///< what is less is calm, whatever the peak
  double level_N_ = 0.0;
  bool in_contact_ = false;
  bool has_begun_ = false;
  bool anew_ = false;
  LiveVerdict verdict_ = LiveVerdict::free;
};

}  // namespace tactus::live
