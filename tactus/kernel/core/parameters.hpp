// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/list.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

/// One description of every parameter.
///
/// A parameter struct is a plain struct with defaults and one static function `fields()` that lists its members. From
/// that list alone follow the loader, its errors, the bounds, the JSON Schema, `--set` and the reference page, so none
/// of them can disagree.
///
///     struct Params {
///       double stiffness_N_per_m = 3950.0;
///       static constexpr auto fields() {
///         return List{field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, positive,
///                                 "Average stiffness (paper A, Table I).")};
///       }
///     };
namespace tactus {

/// The values that a number may take: from `lower` to `upper`, both included unless the lower end is open.
struct Bounds {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false;

  /// False for anything that is not finite.
  [[nodiscard]] constexpr bool contain(double value) const {
    const bool finite = value - value == 0.0;
    return finite && (lower_open ? value > lower : value >= lower) && value <= upper;
  }
};

inline constexpr Bounds any_finite{};
inline constexpr Bounds positive{.lower = 0.0, .lower_open = true};
inline constexpr Bounds non_negative{.lower = 0.0};
constexpr Bounds between(double lower, double upper) { return {.lower = lower, .upper = upper}; }
constexpr Bounds positive_up_to(double upper) { return {.lower = 0.0, .upper = upper, .lower_open = true}; }

/// A key: what it is called, what it may hold and what that means.
struct Key {
  const char* name;
  Unit unit;
  Bounds bounds;
  const char* doc;
};

/// One member of a parameter struct, and its key.
template <class Struct, class Value>
struct Field : Key {
  using value_type = Value;
  Value Struct::*member;
};

/// A parameter struct: default-constructible, with a list of its fields.
template <class T>
concept Described = std::is_default_constructible_v<T> && requires {
  T::fields();
};

/// A number with a unit and bounds.
template <class Struct>
constexpr auto field(const char* name, double Struct::*member, Unit unit, Bounds bounds, const char* doc) {
  return Field<Struct, double>{{name, unit, bounds, doc}, member};
}
/// A whole number with bounds.
template <class Struct>
constexpr auto field(const char* name, std::int64_t Struct::*member, Bounds bounds, const char* doc) {
  return Field<Struct, std::int64_t>{{name, units::none, bounds, doc}, member};
}
/// A choice (an enum with `enumerators`), a text, or a group of further fields.
template <class Struct, class Value>
constexpr auto field(const char* name, Value Struct::*member, const char* doc) {
  static_assert(!std::is_floating_point_v<Value> && !std::is_same_v<Value, std::int64_t>, "a number needs bounds");
  return Field<Struct, Value>{{name, units::none, any_finite, doc}, member};
}

/// One enumerator and the word that stands for it in a file.
template <class Enum>
struct Enumerator {
  Enum value;
  const char* name;
};
// Clang deduces the arguments of an aggregate from version 17 on only.
template <class Enum>
Enumerator(Enum, const char*) -> Enumerator<Enum>;

/// An enum that a file can name: a function `enumerators(Enum)` alongside it lists its words.
template <class E>
concept NamedEnum = std::is_enum_v<E> && requires(E e) {
  enumerators(e);
};

/// The word that stands for `value`.
template <NamedEnum E>
constexpr const char* name_of(E value) {
  for (const auto& entry : enumerators(E{})) {
    if (entry.value == value) return entry.name;
  }
  return "?";
}

/// The fields of `T`, which a program holds once.
template <Described T>
inline constexpr auto fields_of = T::fields();

/// Calls `visit(field)` for each field of `T`, in order.
template <Described T, class Visit>
constexpr void for_each_field(Visit&& visit) {
  fields_of<T>.for_each(visit);
}

/// A number as a user writes it: the shortest text that reads back equal.
std::string format_number(double value);

/// A number in a message: as `format_number`, but with 6 significant digits if that would take more than 9, as a
/// computed one usually does (-6.1 for -6.1000000000000005).
std::string rounded_number(double value);

/// `must be greater than 0 kg`, `must lie between 1 and 20 kHz`, ...
std::string describe_bounds(const Bounds& bounds, const Unit& unit);

/// The error for a value outside its bounds: value, bounds and unit in one sentence.
Error out_of_bounds(std::string_view parameter, double value, const Bounds& bounds, const Unit& unit);

/// A group of fields that only a running program knows, as `OpenGroup` in binding.hpp describes: it checks itself.
template <class T>
concept CheckedGroup = requires(const T& group) {
  { group.check() } -> std::same_as<Check>;
};

namespace detail {

/// Puts an error into `found` where `value` is outside of what the key may hold.
void check_number(const Key& key, double value, Check& found);
/// Puts what was found in a group under the name of the group.
void found_in(const char* group, Check& found);

}  // namespace detail

/// Checks every number of `params`, nested groups included. Returns the first that lies outside its bounds.
template <Described T>
Check validate(const T& params) {
  Check found;
  for_each_field<T>([&](const auto& f) {
    if (found) return;
    const auto& value = params.*f.member;
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (Described<Value>) {
      found = validate(value);
      detail::found_in(f.name, found);
    } else if constexpr (CheckedGroup<Value>) {
      found = value.check();
    } else if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, std::int64_t>) {
      detail::check_number(f, static_cast<double>(value), found);
    }
  });
  return found;
}

}  // namespace tactus
