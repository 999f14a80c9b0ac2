// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/application.hpp>
#include <tactus/interfaces/live/contact_judge.hpp>
#include <tactus/interfaces/live/engine.hpp>
#include <tactus/interfaces/live/messages.hpp>
#include <tactus/interfaces/live/session_history.hpp>
#include <tactus/interfaces/live/settings.hpp>
#include <tactus/interfaces/live/vibration_energy.hpp>

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::live {

/// The live view of an engine: what its loops do as topics, what a visitor does as hand and parameters.
///
/// For each loop `/left/...` and `/right/...`: `block` and `hand_force` at 50 Hz, `state` at about 60 Hz,
/// `teleoperator`, the record of every tick as in the log, and of arms `arms`, with `state`. A client publishes JSON to
/// `/operator/hand` (`{"position_m": x, "engaged": true}`; of arms x may be three numbers, toward the wall and across)
/// and `/operator/command` (`{"command": "tap"}` or `"reset"`). The first client that engages holds the handle until it
/// releases it or leaves; then the hand goes to rest.
class LiveView final : public Application {
 public:
  struct Options {
    bool allow_tuning = false;
    std::string experiment;  ///< its name
  };

  static Result<std::unique_ptr<LiveView>> make(const Settings& settings, const Options& options);

  /// The loops. `Engine::run` is for another thread than the server's.
  [[nodiscard]] Engine& engine() { return *engine_; }
  /// What visitors tried so far. On the view's thread, or after its end.
  [[nodiscard]] const SessionHistory& history() const { return history_; }
  /// Ticks that were lost on the link to this site. Any thread.
  [[nodiscard]] std::uint64_t lost_ticks() const { return lost_ticks_.load(std::memory_order_relaxed); }

  [[nodiscard]] const std::vector<Topic>& topics() const override { return topics_; }
  [[nodiscard]] std::map<std::string, std::string> metadata() const override;
  [[nodiscard]] std::vector<Parameter> parameters() const override { return settings_.parameters(); }
  std::vector<Status> set_parameters(const std::vector<Parameter>& wanted) override;
  std::optional<Status> receive(ClientId client, std::string_view topic, std::string_view encoding,
                                std::string_view bytes) override;
  void leave(ClientId client) override;
  /// Who comes next finds what the experiment states.
  void stand_alone() override;
  /// Shows what the loops did since it was first called.
  void collect(const std::function<bool(std::size_t topic)>& is_wanted, const Publish& publish) override;

 private:
  using Params = std::array<LoopParams, loops>;
  /// Of each loop; those of one axis have no `arms`.
  enum TopicOf : std::size_t { block, hand_force, state, full_rate, arms };

  /// What is known of one loop.
  struct Watched {
    BlockBuilder block;
    ContactJudge judge;
    VibrationEnergy energy;
    LiveState state;
    std::uint32_t run = 0;
    std::uint32_t changes = 0;
    /// Of the hand at the first touch of the contact; none where the contact is older than the loop as it is now.
    std::optional<double> touch_speed_m_per_s = std::nullopt;
    bool rang = false;  ///< at any time of the contact
    std::size_t ticks_to_state = 0;
    double fastest_m_per_s = 0.0;  ///< of the hand, as long as it takes a follower to be where the hand was
    std::uint32_t fastest_at = 0;  ///< the tick in which it was
  };

  LiveView(const Settings& settings, const Options& options, Params params, std::unique_ptr<Engine> engine,
           const ContactJudge& judge, const VibrationEnergy& energy);
  static Result<Params> params_of(const Settings& settings);
  std::optional<Status> move_hand(ClientId client, std::string_view bytes);
  std::optional<Status> command(std::string_view bytes);
  std::optional<Status> start_over(const std::optional<ScriptedTap>& tap);
  Check apply(const Settings& settings);
  void watch(std::size_t loop, const LoopTick& tick);
  /// What the verdict means for the loop, and what to try.
  [[nodiscard]] std::string advice(std::size_t loop) const;
  void show(std::size_t loop, const LoopTick& tick, bool every_tick, const Publish& publish);

  Settings settings_;
  const Settings initial_;
  Options options_;
  Params params_;
  std::unique_ptr<Engine> engine_;
  std::vector<Topic> topics_;
  std::size_t topics_of_loop_;
  std::vector<Watched> watched_;
  std::optional<Engine::Ticks::Reader> ticks_;
  std::atomic<std::uint64_t> lost_ticks_{0};
  std::optional<ClientId> holder_;
  SessionHistory history_;
};

}  // namespace tactus::live
