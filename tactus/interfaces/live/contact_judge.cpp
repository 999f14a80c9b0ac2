// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/contact_judge.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::live {

namespace {

constexpr double apart_s = 0.25;
constexpr double calm_again_s = 0.5;
constexpr double left_for_s = 0.1;
constexpr double too_gentle_N = 0.01;
constexpr double too_gentle_again_N = 0.03;

}  // namespace

Result<ContactJudge> ContactJudge::make(Seconds dt) {
  const auto high_pass = signal::SecondOrderFilter::make(
      {.kind = signal::FilterKind::high_pass, .frequency_Hz = experiments::transient_cutoff_Hz}, dt);
  if (!high_pass) return high_pass.error();
  return ContactJudge(*high_pass, dt);
}

void ContactJudge::reset() {
  high_pass_.reset();
  *this = ContactJudge(high_pass_, Seconds{dt_s_});
}

bool ContactJudge::after(std::int64_t tick, double duration_s) const {
  return static_cast<double>(tick_ - tick) * dt_s_ >= duration_s;
}

void ContactJudge::step(double contact_force_N, bool touched) {
  level_N_ = std::fabs(high_pass_.step(contact_force_N));
  in_contact_ = contact_force_N > 0.0;
  const bool at_the_wall = touched || in_contact_;
  has_begun_ = at_the_wall && (verdict_ == LiveVerdict::free || anew_);
  if (at_the_wall) touched_last_ = tick_;
  if (has_begun_) {
    anew_ = false;
    onset_ = tick_;
    loud_until_ = tick_;
    peak_N_ = 0.0;
    floor_N_ = too_gentle_N;
    verdict_ = LiveVerdict::contact;
  }
  if (verdict_ != LiveVerdict::free) {
    peak_N_ = std::max(peak_N_, level_N_);
    const bool loud = level_N_ > std::max(experiments::settled_share * peak_N_, floor_N_);
    if (loud && verdict_ == LiveVerdict::settled && in_contact_) {
      onset_ = tick_;
      verdict_ = LiveVerdict::contact;
    }
    if (loud) loud_until_ = tick_ + 1;
    const bool quiet = after(loud_until_, experiments::quiet_time_s);
    const bool calm_again = verdict_ == LiveVerdict::rings && after(loud_until_, calm_again_s);
    if (in_contact_ && ((verdict_ == LiveVerdict::contact && quiet) || calm_again)) {
      verdict_ = LiveVerdict::settled;
      floor_N_ = too_gentle_again_N;
    } else if (verdict_ == LiveVerdict::contact && !quiet &&
               after(onset_, experiments::settled_within_s + experiments::quiet_time_s)) {
      verdict_ = LiveVerdict::rings;
    }
    const bool at_rest = verdict_ == LiveVerdict::settled;
    if (after(touched_last_, at_rest ? left_for_s : apart_s)) verdict_ = LiveVerdict::free;
  }
  ++tick_;
}

std::string ContactJudge::cause() const {
  const std::string time_ms = format_number(std::round(1e3 * settling_time_s()));
  switch (verdict_) {
    case LiveVerdict::settled:
      return "The contact force above 15 Hz fell below a tenth of its peak " + time_ms + " ms after the touch.";
    case LiveVerdict::rings:
      return "The contact force above 15 Hz was still above a tenth of its peak " + time_ms + " ms after the touch.";
    case LiveVerdict::contact:
    case LiveVerdict::free:
      break;
  }
  return {};
}

}  // namespace tactus::live
