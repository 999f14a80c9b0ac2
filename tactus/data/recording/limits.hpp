// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// What reading a recording may take, whatever a file states of itself: less than 1 GB of memory and 20 s.
namespace tactus::recording {

/// Of either sign. No instrument measures more, in any unit, and its powers that are summed up stay finite.
inline constexpr double largest_value = 1e30;

/// Of one column: 55 min at 5 kHz.
inline constexpr std::size_t most_samples = std::size_t{1} << 24U;

inline constexpr std::size_t most_table_bytes = std::size_t{256} << 20U;
inline constexpr std::size_t most_table_columns = 4096;

inline constexpr std::size_t most_mat_bytes = std::size_t{512} << 20U;
/// Of all compressed variables together, once they are unpacked.
inline constexpr std::size_t most_unpacked_bytes = std::size_t{256} << 20U;
inline constexpr std::size_t most_mat_variables = 4096;
/// With the members of structs and cell arrays.
inline constexpr std::size_t most_mat_arrays = 100'000;
/// MATLAB's own limit is 63.
inline constexpr std::size_t longest_mat_name = 128;

}  // namespace tactus::recording
