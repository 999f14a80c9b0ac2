// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/session_history.hpp>

#include <algorithm>
#include <utility>

namespace tactus::live {

void SessionHistory::set(std::vector<Parameter> parameters) {
  const bool used = !contacts_.empty() && contacts_.back().setting + 1 == settings_.size();
  if (!used) settings_.pop_back();
  settings_.push_back(std::move(parameters));
}

void SessionHistory::watch(std::size_t loop, const Moment& moment, const ContactJudge& judge) {
  std::optional<std::size_t>& open = open_[loop];
  if (judge.has_begun()) {
    open.reset();
    if (contacts_.size() < most) {
      open = contacts_.size();
      contacts_.push_back({.loop = loop, .setting = settings_.size() - 1, .time_s = moment.time_s});
    } else {
      ++forgotten_;
    }
  }
  if (!open) return;
  if (judge.verdict() == LiveVerdict::free) {
    open.reset();
    return;
  }
  Contact& contact = contacts_[*open];
  // What rang and calmed down has rung.
  if (contact.verdict != LiveVerdict::rings) {
    contact.verdict = judge.verdict();
    contact.settling_time_s = judge.settling_time_s();
  } else {
    contact.settling_time_s = std::max(contact.settling_time_s, judge.settling_time_s());
  }
  contact.peak_force_N = std::max(contact.peak_force_N, moment.contact_force_N);
  contact.vibration_energy_J = moment.vibration_energy_J;
}

}  // namespace tactus::live
