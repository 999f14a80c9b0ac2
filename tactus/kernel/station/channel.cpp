// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/station/channel.hpp>

#include <cmath>

namespace tactus::station {

template <class Payload>
Result<ChannelOf<Payload>> ChannelOf<Payload>::make(const ChannelParams& params, Seconds dt, const Payload& initial) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  return ChannelOf(params, dt, initial);
}

template <class Payload>
ChannelOf<Payload>::ChannelOf(const ChannelParams& params, Seconds dt, const Payload& initial)
    : delay_ticks_(static_cast<std::size_t>(std::lround(params.delay_s / dt.value))),
      jitter_ticks_(std::round(params.jitter_s / dt.value)),
      loss_fraction_(params.loss_fraction),
      random_(static_cast<std::uint64_t>(params.seed)),
      newest_{.message = initial},
      slots_(delay_ticks_ + static_cast<std::size_t>(jitter_ticks_) + 1) {}

template <class Payload>
typename ChannelOf<Payload>::Delivery ChannelOf<Payload>::step(const Payload& message) noexcept {
  ++sent_;
  const bool lost = loss_fraction_ > 0.0 && random_.uniform() < loss_fraction_;
  const double late = jitter_ticks_ > 0.0 ? std::floor(random_.uniform() * (jitter_ticks_ + 1.0)) : 0.0;
  // A later message in the same slot is newer.
  if (!lost) slots_[(now_ + delay_ticks_ + static_cast<std::size_t>(late)) % slots_.size()] = {sent_, message};

  Slot& arriving = slots_[now_];
  const bool fresh = arriving.number > newest_.number;
  if (fresh) newest_ = arriving;
  arriving.number = 0;
  now_ = now_ + 1 == slots_.size() ? 0 : now_ + 1;
  return {.message = newest_.message, .fresh = fresh, .sent_ticks_ago = sent_ - newest_.number};
}

template class ChannelOf<control::Message>;
template class ChannelOf<control::Packet>;
template class ChannelOf<Joints<control::Message>>;
template class ChannelOf<control::JointPacket>;

}  // namespace tactus::station
