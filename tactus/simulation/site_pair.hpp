#pragma once

#include <tactus/control/architecture.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/simulation/channel.hpp>

#include <cstdint>
#include <utility>

namespace tactus::simulation {

/// The link between the sites, one channel each way.
struct LinkParams {
  Channel::Params to_slave{.seed = 1};
  Channel::Params to_master{.seed = 2};
  static constexpr auto fields() {
    return std::tuple{field("to_slave", &LinkParams::to_slave, "The way from master to slave."),
                      field("to_master", &LinkParams::to_master,
                            "The way from slave to master; a message arrives at the next tick at the earliest.")};
  }
};

/// Both sites of a teleoperator on one clock, with the channel between them: the same in virtual and in real time.
///
/// The master steps, then the slave. A message to the slave with no channel delay arrives in the same tick, one to the
/// master at the next.
class SitePair {
 public:
  struct Input {
    double master_position_m = 0.0;  ///< at the motor
    double hand_force_N = 0.0;       ///< positive when the hand pushes toward the environment
    double grip = 1.0;               ///< how firmly the person holds, over nominal
    double slave_position_m = 0.0;   ///< at the motor
    double tip_force_N = 0.0;        ///< positive when the environment pushes the slave back
  };
  struct Output {
    control::MasterOutput master;
    control::SlaveOutput slave;
  };

  /// With a slave that rests at `slave_start_m`. Errors name `control` and `channel`.
  static Result<SitePair> make(const control::ControlParams& control, const LinkParams& channel, Seconds tick,
                               double slave_start_m);

  /// One tick; `elapsed_ticks` since the last is more than 1 after a stall. What the controllers want is scaled by
  /// `share` before their gates: 0 takes every force away at the gates' rate limits. Real-time safe.
  Output step(const Input& input, std::int64_t elapsed_ticks = 1, double share = 1.0) noexcept {
    master_input_ = {.motor_position_m = input.master_position_m,
                     .hand_force_N = input.hand_force_N,
                     .arrival = arrived_,
                     .grip = input.grip};
    output_.master = sites_.master.step(master_input_, share, elapsed_ticks);
    slave_input_ = {.motor_position_m = input.slave_position_m,
                    .tip_force_N = input.tip_force_N,
                    .arrival = to_slave_.step(output_.master.message)};
    output_.slave = sites_.slave.step(slave_input_, share, elapsed_ticks);
    arrived_ = to_master_.step(output_.slave.message);
    return output_;
  }

  /// Goes on with the channels of `made`, which has not been stepped, and gives it the own ones; what is on its way is
  /// lost. Between ticks. Real-time safe.
  void exchange_channels(SitePair& made) noexcept;
  /// Goes on with the controllers of `made`, brought to rest at the latest tick (`Site::exchange_controller`); the
  /// gates stay. Between ticks; does not allocate, but takes as long as a thousand ticks.
  void exchange_controllers(SitePair& made) noexcept;

  /// Neither site commanded a force at the latest tick.
  [[nodiscard]] bool at_rest() const noexcept {
    return output_.master.motor_force_N == 0.0 && output_.master.handle_force_N == 0.0 &&
           output_.slave.motor_force_N == 0.0;
  }
  /// False once a safety gate has latched a fault.
  [[nodiscard]] bool healthy() const noexcept {
    return sites_.master.fault() == control::GateFault::none && sites_.slave.fault() == control::GateFault::none;
  }

 private:
  SitePair(control::Sites sites, Channel to_slave, Channel to_master)
      : sites_(std::move(sites)), to_slave_(std::move(to_slave)), to_master_(std::move(to_master)) {}

  control::Sites sites_;
  Channel to_slave_;
  Channel to_master_;
  control::Arrival arrived_;           ///< at the master, for its next tick
  control::MasterInput master_input_;  ///< of the latest tick, as the two below
  control::SlaveInput slave_input_;
  Output output_;
};

}  // namespace tactus::simulation
