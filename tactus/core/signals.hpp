#pragma once

#include <tactus/core/units.hpp>

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>

/// One description of everything that can be looked at.
///
/// A record is a plain, trivially copyable struct that one tick fills. Its static function `signals()` describes the
/// members, as `fields()` does for parameters. From that list follow the bytes of the log, its schema, and the heads of
/// the exported columns, so none of them can disagree.
///
///     struct Record {
///       double force_N = 0.0;
///       static constexpr auto signals() {
///         return std::tuple{observed("force_N", &Record::force_N, units::newton, "master", "hand",
///                                    "pushes the hand back", "Displayed force, at the motor.")};
///       }
///     };
namespace tactus {

/// One member of a record.
template <class Record, class Value>
struct Observed {
  static_assert(std::is_same_v<Value, double> || std::is_same_v<Value, std::int64_t> || std::is_same_v<Value, bool>,
                "a signal is a double, an int64 or a bool");
  using value_type = Value;
  const char* name;  ///< of the member, with the suffix of its unit
  Value Record::*member;
  Unit unit;
  const char* site;   ///< where it arises: `master`, `slave`, `environment`, `channel`, or empty
  const char* frame;  ///< to which point or axis all quantities are translated (`hand`), or empty
  const char* sign;   ///< what a positive value means, or empty
  const char* doc;    ///< one sentence
};

template <class Record, class Value>
constexpr auto observed(const char* name, Value Record::*member, Unit unit, const char* site, const char* frame,
                        const char* sign, const char* doc) {
  return Observed<Record, Value>{name, member, unit, site, frame, sign, doc};
}

/// A record that can cross from the servo thread to a log: one copy of plain memory, every member described.
template <class T>
concept Recordable = std::is_trivially_copyable_v<T> && std::is_default_constructible_v<T> && requires {
  T::signals();
};

/// Calls `visit(observed)` for each signal of `T`, in order.
template <Recordable T, class Visit>
constexpr void for_each_signal(Visit&& visit) {
  std::apply([&](const auto&... all) { (visit(all), ...); }, T::signals());
}

}  // namespace tactus
