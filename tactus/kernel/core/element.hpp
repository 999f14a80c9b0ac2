// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <concepts>
#include <type_traits>

namespace tactus {

// Version 14 of the formatter tears a `noexcept` requirement apart.
// clang-format off

/// A small value type with parameters, state and one hot call: the stuff that sites and plants are made of.
///
/// - `make` is cold: it validates and precomputes, so an invalid element cannot exist.
/// - `step` is hot: no allocation, lock, clock, exception or stream. It advances the element by the sample time that
///   `make` was given and returns the output.
/// - `reset` brings back the state that `make` left, so a reset element and a new one behave alike.
/// - An element is trivially copyable: a snapshot, a fork in simulation, a log record and a hand-off between threads
///   are each one copy, and a copy continues exactly as the original would.
///
/// `tests/laws.hpp` holds every element to these laws.
template <class E>
concept Element = std::is_trivially_copyable_v<E> &&
                  requires(E element, const typename E::Params& params, const typename E::Input& input, Seconds dt) {
                    { E::make(params, dt) } -> std::same_as<Result<E>>;
                    { element.step(input) } noexcept -> std::same_as<typename E::Output>;
                    { element.reset() } noexcept;
                  };
// clang-format on

}  // namespace tactus
