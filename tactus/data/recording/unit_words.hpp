// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace tactus::recording {

/// The symbol of a unit that people spell in many ways: `Newton`, `newtons` and `N` give `N`; `Nm`, `N.m`, `N*m` and
/// `newton metres` give `N m`; `degrees` and `°` give `deg`; `sec` gives `s`. Empty for a text that is no unit.
std::string unit_of(std::string_view text);

/// Whether a unit can be that of the quantity that a column is called after, such as `x`, `theta`, `F` or `time`. True
/// for a name that names no quantity.
bool unit_fits_name(std::string_view name, std::string_view unit);
}  // namespace tactus::recording
