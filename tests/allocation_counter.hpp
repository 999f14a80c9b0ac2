// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus::laws {

/// How often this program has asked the heap for memory so far, by `new`, `malloc` or a relative.
///
/// Counts only in a program that links `allocation_counter`.
std::uint64_t allocation_count() noexcept;
/// Those of the calling thread alone.
std::uint64_t own_allocation_count() noexcept;

}  // namespace tactus::laws
