#pragma once

#include <tactus/core/parameters.hpp>

#include <algorithm>
#include <type_traits>

namespace tactus::experiments {

/// Brings every number that stands directly in `params` to the nearest end of its closed bounds. For values drawn
/// around what a person wrote: a tremor of 29 Hz is allowed, and so must be every draw around it.
template <Described T>
void limit_to_bounds(T& params) {
  for_each_field<T>([&](const auto& f) {
    auto& value = params.*f.member;
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, double>) {
      value = std::clamp(value, f.bounds.lower, f.bounds.upper);
    }
  });
}

}  // namespace tactus::experiments
