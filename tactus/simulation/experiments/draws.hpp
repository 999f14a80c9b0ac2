// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <string>
#include <type_traits>

namespace tactus::experiments {

/// Brings every number that is directly in `params` to the nearest end of its closed bounds. For values drawn
/// around what an operator wrote: a tremor of 29 Hz is allowed, and so must be every draw around it.
template <Described T>
void limit_to_bounds(T& params) {
  for_each_field<T>([&](const auto& f) {
    auto& value = params.*f.member;
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, double>) {
      value = std::clamp(value, f.bounds.lower, f.bounds.upper);
    }
  });
}

/// `inconsistent` for ends of a range of the task that do not follow each other; the names are keys of `[task]`.
inline Check check_range(double lower, double upper, const char* lower_name, const char* upper_name) {
  if (lower <= upper) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = std::string("task.") + upper_name,
               .message = rounded_number(upper) + " is less than " + lower_name + ", " + rounded_number(lower) +
                          ": raise one or lower the other",
               .place = {}};
}

}  // namespace tactus::experiments
