// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/map.hpp>
#include <tactus/kernel/core/result.hpp>

#include <filesystem>

namespace tactus::stability {

/// Writes a map as HDF5: data sets `verdict` (attribute `words`: what each number means), `settling_time`, `contacts`,
/// `peak_force` and `residual_rms`, each with one dimension for an axis and the attribute `unit`, and in the group
/// `axes` one data set for each axis, named `0-KEY`, `1-KEY`, … in the order of the dimensions, with `unit` and, for
/// words, `words`. All or nothing: written alongside its place and then renamed.
/// Errors: `unwritable`.
Check write_hdf5(const std::filesystem::path& path, const MapResult& map);

}  // namespace tactus::stability
