// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/binding.hpp>

#include <span>
#include <string_view>

namespace tactus::configuration {

/// The path of the section, or of the value, that `given` was probably meant to be; empty when none is near. It counts
/// as near by its last part alone (a key in another section), by the whole path (`control_gain` for `control.gain`),
/// and without its unit.
std::string_view nearest_path(std::string_view given, bool is_section, std::span<const Binding> bindings);

}  // namespace tactus::configuration
