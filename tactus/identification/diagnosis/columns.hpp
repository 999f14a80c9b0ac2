// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/recording.hpp>
#include <tactus/identification/axis/axis_units.hpp>
#include <tactus/identification/diagnosis/signals.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::diagnosis {

constexpr std::size_t index_of(Role role) { return static_cast<std::size_t>(role); }

/// `step_of`; less for a force that is switched between two or three levels, for it is not measured in steps of that
/// size.
double resolution_of(Role role, const std::vector<double>& values);

/// In small letters, as names are compared.
std::string lower(std::string_view text);

/// The units in which the column of a role may be.
std::span<const identification::KnownUnit> units_of(Role role);

/// The one column of a recording that plays this role, by its name and unit; empty for none and for several alike.
std::string find_column(Role role, const std::vector<recording::Entry>& entries);

/// The same of the velocity of master or leader, or of slave or follower, in rad/s, m/s or without a unit. `position`:
/// master_position or slave_position.
std::string find_velocity(Role position, const std::vector<recording::Entry>& entries);

/// The columns of a table that play no role, and why where their unit is the reason, in sentences.
std::vector<std::string> notes_on_columns(const SignalRoles& roles, const std::vector<recording::Entry>& entries,
                                          const Signals& signals);

}  // namespace tactus::diagnosis
