// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/entry.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/core/result.hpp>

#include <span>

namespace tactus::configuration {

/// Stores what was written where `binding` points, or states why it does not fit; nothing to store for a section. The
/// error has no place yet.
Check assign(const Entry& entry, const Binding& binding);

/// The error for a key that no binding has, with the nearest key meant or the keys there are. It has no place yet.
Error unknown_key(const Entry& entry, std::span<const Binding> bindings);

}  // namespace tactus::configuration
