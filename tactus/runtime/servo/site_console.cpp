// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/site_console.hpp>

namespace tactus::runtime {

namespace {

constexpr std::int64_t line_every_ns = 1'000'000'000;

}  // namespace

control::SiteRequests SiteConsole::step(const station::Tick& tick, control::SiteState state, bool heard) noexcept {
  now_ns_ = tick.began_ns;
  if (!begun_) {
    begun_ = true;
    start_ns_ = now_ns_;
    second_ends_ns_ = now_ns_ + line_every_ns;
  }
  time_s_ = static_cast<double>(now_ns_ - start_ns_) * 1e-9;

  if (exchange_->end.asked()) leaving_ = true;
  if (exchange_->person_lost.load(std::memory_order_relaxed)) buttons_.lose_person();
  if (heard) heard_s_ += settings_.tick_s;
  mark_.reset();
  taken_.reset();
  if (buttons_.ready()) {
    SiteCommand asked;
    if (settings_.arm_at_once && heard_s_ > settings_.listen_before_arming_s) {
      settings_.arm_at_once = false;
      buttons_.take(SiteWord::arm);
    } else if (exchange_->words.try_pop(asked)) {
      taken_ = asked;
      mark_ = mark_of(asked.word);
      buttons_.take(asked, state);
    }
  }
  control::SiteRequests pressed = buttons_.step(state);
  pressed.leave = leaving_;
  return pressed;
}

bool SiteConsole::ends_second() noexcept {
  if (now_ns_ < second_ends_ns_) return false;
  second_ends_ns_ += line_every_ns;
  return true;
}

bool SiteConsole::over(const station::Tick& tick, bool works, bool gives_force) noexcept {
  if (settings_.duration_s > 0.0 && time_s_ >= settings_.duration_s) leaving_ = true;
  // What was asked for after this tick's step is heard at the next.
  if (!leaving_ || works) return false;
  leaving_s_ += static_cast<double>(tick.missed + 1) * settings_.tick_s;
  return !gives_force || leaving_s_ >= longest_ramp_s;
}

}  // namespace tactus::runtime
