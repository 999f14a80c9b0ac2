// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <optional>

namespace tactus::ros2 {

/// Where another program means the hand to be, made into a path that a hand could take: x ← x + clamp(aim − x, ±v·dt),
/// the aim clamped to the reach. Until the first request the path is the scripted one. When no request has come for a
/// while, the hand stays where it is: a program that has died must not continue pushing.
///
/// It is before the operator, so all that follows from it passes cancellation, limits and safety gates as the
/// operator's own motion does. An element.
class RemotePath {
 public:
  struct Params {
    double lowest_m = -0.1;
    double highest_m = 0.1;
    double fastest_m_per_s = 0.5;
    double timeout_s = 0.2;
    static constexpr auto fields() {
      return List{
          field("lowest_m", &Params::lowest_m, units::metre, between(-1.0, 1.0), "Smallest position that is followed."),
          field("highest_m", &Params::highest_m, units::metre, between(-1.0, 1.0),
                "Largest position that is followed."),
          field("fastest_m_per_s", &Params::fastest_m_per_s, units::metre_per_second, positive_up_to(2.0),
                "Fastest that the hand follows."),
          field("timeout_s", &Params::timeout_s, units::second, between(0.001, 10.0),
                "Without a request for this time the hand stays at its position.")};
    }
  };
  struct Input {
    double scripted_m = 0.0;  ///< where the hand would be without a request
    std::optional<double> requested_m =
        {};  ///< that has arrived since the last tick; one that is not finite counts as none
  };
  using Output = double;

  /// Errors: `out_of_bounds` and `inconsistent`, with the name of the parameter.
  static Result<RemotePath> make(const Params& params, Seconds dt);

  /// The intended position in m at this tick. Real-time safe.
  double step(const Input& input) noexcept;
  void reset() noexcept;

  /// Whether a request has ever come.
  [[nodiscard]] bool driven() const noexcept { return driven_; }

 private:
  RemotePath(const Params& params, double longest_step_m, std::int64_t timeout_ticks)
      : lowest_m_(params.lowest_m),
        highest_m_(params.highest_m),
        longest_step_m_(longest_step_m),
        timeout_ticks_(timeout_ticks) {}

  double lowest_m_;
  double highest_m_;
  double longest_step_m_;
  std::int64_t timeout_ticks_;
  double position_m_ = 0.0;
  double aim_m_ = 0.0;
  std::int64_t ticks_since_request_ = 0;
  bool driven_ = false;
};

}  // namespace tactus::ros2
