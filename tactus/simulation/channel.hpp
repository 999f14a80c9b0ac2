#pragma once

#include <tactus/control/site.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/signal/random.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tactus::simulation {

/// One way of the link between the sites, as a datagram network is: a delay, jitter that may reorder, and loss.
///
/// Each message takes the delay plus an evenly drawn share of the jitter, in whole ticks. Of the messages that arrive
/// in a tick the newest counts, and one that is older than what came before is dropped: an old state is never applied.
/// A tick in which nothing new arrives keeps the last message and says that it is not fresh.
class Channel {
 public:
  struct Params {
    double delay_s = 0.0;
    double jitter_s = 0.0;
    double loss_fraction = 0.0;
    std::int64_t seed = 1;
    static constexpr auto fields() {
      return std::tuple{field("delay_s", &Params::delay_s, units::second, between(0.0, 1.0),
                              "Shortest delay, rounded to whole ticks."),
                        field("jitter_s", &Params::jitter_s, units::second, between(0.0, 1.0),
                              "Longest delay on top of it, drawn evenly for every message."),
                        field("loss_fraction", &Params::loss_fraction, units::none, between(0.0, 1.0),
                              "Share of the messages that never arrive."),
                        field("seed", &Params::seed, non_negative, "Seed of jitter and loss.")};
    }
  };

  /// A channel on which `initial` is what arrived last, long ago.
  static Result<Channel> make(const Params& params, Seconds dt, const control::Message& initial = {});

  /// Sends this tick's message and returns what arrives in this tick. Without delay that is the message itself. Does
  /// not allocate.
  control::Arrival step(const control::Message& message) noexcept;

  /// Lets a channel on which nothing was sent yet go on from what `before` delivered last. Does not allocate.
  void continue_from(const Channel& before) noexcept { newest_.message = before.newest_.message; }

 private:
  /// What arrives in one tick; messages are numbered from 1, and 0 is none.
  struct Slot {
    std::int64_t number = 0;
    control::Message message;
  };

  Channel(const Params& params, Seconds dt, const control::Message& initial);

  std::size_t delay_ticks_;
  double jitter_ticks_;
  double loss_fraction_;
  signal::Random random_;
  std::int64_t sent_ = 0;
  std::size_t now_ = 0;
  Slot newest_;
  std::vector<Slot> slots_;  ///< a ring, as long as the longest way takes
};

}  // namespace tactus::simulation
