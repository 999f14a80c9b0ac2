// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/application.hpp>
#include <tactus/interfaces/live/contact_judge.hpp>
#include <tactus/interfaces/live/engine.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace tactus::live {

/// What visitors tried and what came of it, for the report of a session: every contact of either loop, and the values
/// of the parameters that it happened under. Of the view's thread.
class SessionHistory {
 public:
  /// One contact of a loop with its wall, from a touch on.
  struct Contact {
    std::size_t loop = 0;
    std::size_t setting = 0;  ///< place in `settings`
    double time_s = 0.0;      ///< of the touch, since the loops began
    /// At its end: settled, or rings where it ever rang; contact where it was over before either.
    LiveVerdict verdict = LiveVerdict::contact;
    double settling_time_s = 0.0;     ///< until the last loud moment
    double peak_force_N = 0.0;        ///< of the slave's tip
    double vibration_energy_J = 0.0;  ///< of `VibrationEnergy`, at its end
  };
  /// What a loop did in a tick, as its view has judged it.
  struct Moment {
    double time_s = 0.0;
    double contact_force_N = 0.0;
    double vibration_energy_J = 0.0;
  };

  /// How many contacts a session remembers; the rest are only counted.
  static constexpr std::size_t most = 10'000;

  /// `initial`: the parameters that the loops begin with.
  explicit SessionHistory(std::vector<Parameter> initial) { settings_.push_back(std::move(initial)); }

  /// From now on these are the parameters. Values that saw no contact are forgotten, as while a slider is dragged.
  void set(std::vector<Parameter> parameters);
  /// One tick of a loop.
  void watch(std::size_t loop, const Moment& moment, const ContactJudge& judge);
  /// The loop starts over: its contact, if there is one, is at its end.
  void start_over(std::size_t loop) { open_[loop].reset(); }

  [[nodiscard]] const std::vector<Contact>& contacts() const { return contacts_; }
  /// Each has all parameters, in the order of `Settings::parameters`.
  [[nodiscard]] const std::vector<std::vector<Parameter>>& settings() const { return settings_; }
  /// Contacts that were not remembered.
  [[nodiscard]] std::uint64_t forgotten() const { return forgotten_; }

 private:
  std::vector<std::vector<Parameter>> settings_;
  std::vector<Contact> contacts_;
  std::array<std::optional<std::size_t>, loops> open_;  ///< place of the contact that continues, or has just ended
  std::uint64_t forgotten_ = 0;
};

}  // namespace tactus::live
