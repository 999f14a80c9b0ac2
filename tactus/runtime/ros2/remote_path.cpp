// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/runtime/ros2/remote_path.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::ros2 {

Result<RemotePath> RemotePath::make(const Params& params, Seconds dt) {
  if (Check error = signal::check(params, dt)) return *std::move(error);
  if (params.lowest_m > params.highest_m) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "lowest_m",
                 .message = rounded_number(params.lowest_m) + " m is above highest_m, " +
                            rounded_number(params.highest_m) + " m: raise one or lower the other",
                 .place = {}};
  }
  return RemotePath(params, params.fastest_m_per_s * dt.value, std::llround(params.timeout_s / dt.value));
}

double RemotePath::step(const Input& input) noexcept {
  if (input.requested_m && std::isfinite(*input.requested_m)) {
    driven_ = true;
    ticks_since_request_ = 0;
    aim_m_ = std::clamp(*input.requested_m, lowest_m_, highest_m_);
  } else if (driven_ && ++ticks_since_request_ > timeout_ticks_) {
    ticks_since_request_ = timeout_ticks_;
    aim_m_ = position_m_;
  }
  if (!driven_) return position_m_ = input.scripted_m;
  return position_m_ += std::clamp(aim_m_ - position_m_, -longest_step_m_, longest_step_m_);
}

void RemotePath::reset() noexcept {
  position_m_ = 0.0;
  aim_m_ = 0.0;
  ticks_since_request_ = 0;
  driven_ = false;
}

}  // namespace tactus::ros2
