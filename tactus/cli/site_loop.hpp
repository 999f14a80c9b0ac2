#pragma once

#include <tactus/link/arming.hpp>
#include <tactus/link/endpoint.hpp>
#include <tactus/link/following.hpp>
#include <tactus/runtime/servo_thread.hpp>
#include <tactus/simulation/site_plants.hpp>
#include <tactus/simulation/tapping.hpp>
#include <tactus/telemetry/ring.hpp>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <variant>

namespace tactus::cli {

/// One second of a site, for the display.
struct SiteSecond {
  double time_s = 0.0;  ///< of its end, since the start
  link::Standing standing = link::Standing::hold;
  link::HoldCause cause = link::HoldCause::not_armed;
  double round_trip_s = 0.0;  ///< mean over the messages of the second, as age
  double age_s = 0.0;
  double loss_fraction = 0.0;
  double peak_force_N = 0.0;  ///< of the motor, either way
};

/// What a site went through.
struct SiteTotals {
  double duration_s = 0.0;
  std::int64_t ticks = 0;
  std::int64_t active_ticks = 0;
  std::int64_t armings = 0;
  std::array<std::int64_t, 7> holds{};  ///< by `HoldCause`
  double longest_silence_at_hold_s = 0.0;
  double round_trip_mean_s = 0.0;
  double round_trip_max_s = 0.0;
  double age_mean_s = 0.0;
  double age_max_s = 0.0;
  double peak_force_N = 0.0;
  double largest_force_step_N = 0.0;           ///< of the motor from tick to tick
  double largest_resuming_force_step_N = 0.0;  ///< the same in the first second after each arming
  double force_step_limit_N = 0.0;             ///< what the gate allows
  std::int64_t steps_above_limit = 0;
  std::int64_t stale_applied = 0;  ///< an older message after a newer one, or one over age: must be 0
  std::int64_t not_finite = 0;     ///< forces or messages that are not finite: must be 0
  link::Endpoint::Counters link;
};

/// The way a person taps on and on: there, press, back, rest, with the mean speed and depth of an experiment's taps.
class RepeatedTaps {
 public:
  explicit RepeatedTaps(const simulation::TappingParams& params);
  [[nodiscard]] double position_m(double time_s) const noexcept;
  [[nodiscard]] double start_m() const noexcept { return there_.start_m; }

 private:
  mechanics::MinimumJerk there_;
  mechanics::MinimumJerk back_;
  double period_s_;
};

/// What a running site and the rest of its program tell one another. No locks.
struct SiteExchange {
  std::atomic<bool> arm{false};  ///< a person asks to arm
  telemetry::Ring<SiteSecond, 64> seconds;
};

/// One site of two: link, arming, following, controller behind its gates, simulated plant. The step of a servo thread;
/// does not allocate, lock or block.
class SiteLoop {
 public:
  struct Settings {
    link::Endpoint::Settings link;
    link::Following::Params following;
    double duration_s = 0.0;   ///< 0 for no end
    bool arm_at_once = false;  ///< the master, as soon as it hears the slave for the first time
  };

  /// `exchange` must outlive the loop. Errors: what is wrong with the parameters or the link.
  static Result<SiteLoop> make(const simulation::TappingParams& params, const Settings& settings,
                               SiteExchange& exchange);

  /// One tick. False after `duration_s`.
  bool operator()(const runtime::Tick& tick) noexcept;

  /// After the last tick.
  [[nodiscard]] SiteTotals totals() const;

 private:
  struct Stepped {
    control::Message message;
    double motor_force_N;
    bool fault;
  };
  struct Master {
    simulation::MasterPlant plant;
    control::MasterSite site;
    RepeatedTaps path;
    simulation::Clock clock;
    double path_s = 0.0;  ///< how far along the path the person is; a person waits while the site holds
    Stepped step(const control::Arrival& arrival, bool active) noexcept;
  };
  struct Slave {
    simulation::SlavePlant plant;
    control::SlaveSite site;
    simulation::Clock clock;
    Stepped step(const control::Arrival& arrival, bool active) noexcept;
  };
  using Work = std::variant<Master, Slave>;

  SiteLoop(const Settings& settings, SiteExchange& exchange, link::Endpoint endpoint, const link::Following& following,
           Work work, double tick_s, double force_step_limit_N);
  void judge(const link::Endpoint::Received& received, link::Standing before) noexcept;
  void measure(const Stepped& stepped) noexcept;
  void end_second() noexcept;

  Settings settings_;
  SiteExchange* exchange_;
  link::Endpoint endpoint_;
  link::Arming arming_;
  link::Following following_;
  Work work_;
  double tick_s_;
  bool fault_ = false;
  bool may_arm_at_once_;
  double heard_s_ = 0.0;  ///< since the other site was heard first
  double motor_force_N_ = 0.0;
  std::int64_t ticks_since_arming_ = 0;
  std::uint64_t last_session_ = 0;
  std::uint64_t last_sequence_ = 0;
  SiteTotals totals_;
  double round_trip_sum_s_ = 0.0, age_sum_s_ = 0.0;
  std::int64_t messages_ = 0;
  // Of the running second.
  std::int64_t start_ns_ = 0;
  std::int64_t second_ends_ns_ = 0;
  double second_round_trip_sum_s_ = 0.0, second_age_sum_s_ = 0.0, second_peak_N_ = 0.0;
  std::int64_t second_messages_ = 0;
  std::uint64_t second_expected_ = 0, second_arrived_ = 0;
};

}  // namespace tactus::cli
