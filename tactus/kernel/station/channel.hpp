// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tactus::station {

/// A way of the link between the sites, as a datagram network is.
struct ChannelParams {
  double delay_s = 0.0;
  double jitter_s = 0.0;
  double loss_fraction = 0.0;
  std::int64_t seed = 1;
  static constexpr auto fields() {
    return List{field("delay_s", &ChannelParams::delay_s, units::second, between(0.0, 1.0),
                      "Shortest delay, rounded to whole control cycles."),
                field("jitter_s", &ChannelParams::jitter_s, units::second, between(0.0, 1.0),
                      "Longest additional delay, drawn uniformly for every message."),
                field("loss_fraction", &ChannelParams::loss_fraction, units::none, between(0.0, 1.0),
                      "Share of the messages that never arrive."),
                field("seed", &ChannelParams::seed, non_negative, "Seed of jitter and loss.")};
  }
};

/// The link between the sites, one channel each way.
struct LinkParams {
  ChannelParams to_slave{.seed = 1};
  ChannelParams to_master{.seed = 2};
  static constexpr auto fields() {
    return List{field("to_slave", &LinkParams::to_slave, "The link from master to slave."),
                field("to_master", &LinkParams::to_master,
                      "The link from slave to master; a message arrives in the next control cycle at the earliest.")};
  }
};

/// One way of the link in ticks of one clock: a delay, jitter that may reorder, and loss. `Payload` is a `Message` or a
/// `Packet`, of one axis or of several joints.
///
/// Each message takes the delay plus an evenly drawn share of the jitter, in whole ticks. Of the messages that arrive
/// in a tick the newest counts, and one that is older than what came before is dropped: an old state is never applied.
/// A tick in which nothing new arrives keeps the last message and states that it is not fresh.
template <class Payload>
class ChannelOf {
 public:
  using Params = ChannelParams;
  /// What has come.
  struct Delivery {
    Payload message{};
    bool fresh = false;
    std::int64_t sent_ticks_ago = 0;  ///< of a fresh one
  };

  /// A channel on which `initial` is what arrived last, long ago.
  static Result<ChannelOf> make(const ChannelParams& params, Seconds dt, const Payload& initial = {});

  /// Sends this tick's message and returns what arrives in this tick. Without delay that is the message itself. Does
  /// not allocate.
  Delivery step(const Payload& message) noexcept;

  /// Lets a channel on which nothing was sent yet continue from what `before` delivered last. Does not allocate.
  void continue_from(const ChannelOf& before) noexcept { newest_.message = before.newest_.message; }

 private:
  /// What arrives in one tick; messages are numbered from 1, and 0: none.
  struct Slot {
    std::int64_t number = 0;
    Payload message{};
  };

  ChannelOf(const ChannelParams& params, Seconds dt, const Payload& initial);

  std::size_t delay_ticks_;
  double jitter_ticks_;
  double loss_fraction_;
  signal::Random random_;
  std::int64_t sent_ = 0;
  std::size_t now_ = 0;
  Slot newest_;
  std::vector<Slot> slots_;  ///< a ring, as long as the longest way takes
};

using Channel = ChannelOf<control::Message>;
using PacketChannel = ChannelOf<control::Packet>;

}  // namespace tactus::station
