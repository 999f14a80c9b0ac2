// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/site_buttons.hpp>

namespace tactus::runtime {

void SiteButtons::take(const SiteCommand& command, control::SiteState state) noexcept {
  using control::SiteState;
  switch (command.word) {
    case SiteWord::arm:
      next_.arm = next_.dead_man = true;
      next_.tare = false;
      break;
    case SiteWord::press:
      next_.dead_man = true;
      next_.tare = false;
      break;
    case SiteWord::tare:
      next_.dead_man = false;
      next_.tare = true;
      tares_anew_ = true;
      next_.arm = command.source == RequestSource::operator_input && state != SiteState::armed &&
                  state != SiteState::active && state != SiteState::fault;
      break;
    case SiteWord::set:
      next_.force_gain = command.value;
      break;
    case SiteWord::release:
      next_.dead_man = false;
      break;
    case SiteWord::clutch:
      next_.clutch = true;
      break;
    case SiteWord::unclutch:
      next_.clutch = false;
      break;
    case SiteWord::stop:
      next_.emergency_stop = true;
      next_.tare = false;
      break;
    case SiteWord::clear:
      next_.emergency_stop = false;
      next_.clear = true;
      break;
    case SiteWord::start:
    case SiteWord::keep:
    case SiteWord::discard:
      break;
  }
}

control::SiteRequests SiteButtons::step(control::SiteState state) noexcept {
  using control::SiteState;
  control::SiteRequests pressed = next_;
  // What is pressed at the very first tick is not heard.
  pressed.align = begun_ && !aligned_;
  aligned_ = begun_;
  begun_ = true;
  // Let go where the site is armed anew, so that it is pressed after arming.
  const bool follows = state == SiteState::active || (state == SiteState::armed && !pressed.arm);
  pressed.dead_man = next_.dead_man && follows && !lost_;
  // One that was asked for before is let go first, so that it rises.
  pressed.tare = next_.tare && !tares_anew_;
  tares_anew_ = false;
  pushed_ = pressed.arm || pressed.clear;
  next_.arm = next_.clear = false;
  return pressed;
}

}  // namespace tactus::runtime
