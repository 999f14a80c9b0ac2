// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/message_follower.hpp>

namespace tactus::control {

namespace {

/// The velocity of told positions is averaged over this long.
constexpr double velocity_memory_s = 0.01;

double toward_zero(double value, double most) { return value - std::clamp(value, -most, most); }

}  // namespace

void MessageFollower::learn(const Message& told) noexcept {
  const double since_s = silence_s_ + dt_s_;
  if (learnt_) {
    const double measured = (told.position_m - told_.position_m) / since_s;
    velocity_m_per_s_ += since_s / (velocity_memory_s + since_s) * (measured - velocity_m_per_s_);
    out_.energy_J += told.energy_J - last_energy_J_;
  }
  last_energy_J_ = told.energy_J;
  told_ = told;
  ahead_m_ = 0.0;
  share_ = 1.0;
  silence_s_ = 0.0;
  learnt_ = true;
}

void MessageFollower::lapse(std::int64_t elapsed_ticks) noexcept {
  // After a stall of many ticks all has decayed; there is no need to count each.
  const std::int64_t ticks = std::min(elapsed_ticks, static_cast<std::int64_t>(std::lround(1.0 / dt_s_)));
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    silence_s_ += dt_s_;
    if (silence_s_ > params_.extrapolation_s) share_ *= decay_;
    ahead_m_ += share_ * velocity_m_per_s_ * dt_s_;
  }
}

void MessageFollower::resume() noexcept {
  gap_.position_m = out_.position_m - told_.position_m;
  gap_.velocity_m_per_s = out_.velocity_m_per_s - told_.velocity_m_per_s;
  gap_.force_N = out_.force_N - told_.force_N;
  gap_.wave = out_.wave - told_.wave;
}

Arrival MessageFollower::step(const Input& input) noexcept {
  const double most_m = params_.catch_up_m_per_s * dt_s_, most = params_.catch_up_N_per_s * dt_s_;
  if (!input.following) {
    const double fade = most * static_cast<double>(input.elapsed_ticks);
    out_.velocity_m_per_s = toward_zero(out_.velocity_m_per_s, fade);
    out_.force_N = toward_zero(out_.force_N, fade);
    out_.wave = toward_zero(out_.wave, fade);
    follows_ = learnt_ = false;
    velocity_m_per_s_ = share_ = ahead_m_ = silence_s_ = 0.0;
    gap_ = {};
    return {.message = out_, .fresh = false};
  }
  const bool begins = !follows_;
  follows_ = true;
  if (input.arrival.fresh || begins) {
    const bool interrupted = begins || silence_s_ > 0.0 || input.elapsed_ticks > 1;
    if (!begins && interrupted) {
      // What would be given now if the silence went on, so that only the surprise makes a gap.
      lapse(input.elapsed_ticks);
      out_.position_m = told_.position_m + ahead_m_ + gap_.position_m;
      silence_s_ -= dt_s_;
    }
    learn(input.arrival.message);
    if (interrupted) resume();
  } else {
    lapse(input.elapsed_ticks);
  }
  gap_.position_m = toward_zero(gap_.position_m, most_m);
  gap_.velocity_m_per_s = toward_zero(gap_.velocity_m_per_s, most);
  gap_.force_N = toward_zero(gap_.force_N, most);
  gap_.wave = toward_zero(gap_.wave, most);
  out_.position_m = told_.position_m + ahead_m_ + gap_.position_m;
  out_.velocity_m_per_s = share_ * told_.velocity_m_per_s + gap_.velocity_m_per_s;
  out_.force_N = share_ * told_.force_N + gap_.force_N;
  out_.wave = share_ * told_.wave + gap_.wave;
  return {.message = out_, .fresh = input.arrival.fresh};
}

void MessageFollower::settle(double position_m) noexcept {
  told_ = out_ = {.position_m = position_m};
  gap_ = {};
  velocity_m_per_s_ = ahead_m_ = share_ = silence_s_ = last_energy_J_ = 0.0;
  follows_ = learnt_ = false;
}

}  // namespace tactus::control
