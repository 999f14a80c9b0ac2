// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/list.hpp>
#include <tactus/kernel/core/units.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>

/// One description of everything that can be looked at.
///
/// A record is a plain, trivially copyable struct that one tick fills. Its static function `signals()` describes the
/// members, as `fields()` does for parameters. From that list follow the bytes of the log, its schema, and the heads of
/// the exported columns, so none of them can disagree.
///
///     struct Record {
///       double force_N = 0.0;
///       static constexpr auto signals() {
///         return List{observed("force_N", &Record::force_N, units::newton, "master", "hand",
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

/// The signals of `T`, which a program holds once.
template <Recordable T>
inline constexpr auto signals_of = T::signals();

/// Calls `visit(observed)` for each signal of `T`, in order.
template <Recordable T, class Visit>
constexpr void for_each_signal(Visit&& visit) {
  signals_of<T>.for_each(visit);
}

/// A text as a template argument.
template <std::size_t size>
struct FixedText {
  char text[size]{};
  constexpr FixedText(const char (&from)[size]) { std::copy_n(from, size, text); }
};

namespace detail {

/// The signals of `T` as members of `Derived`, each name after `prefix`.
template <class Derived, class T, FixedText prefix>
struct PartOf {
  template <std::size_t I>
  static constexpr auto name = [] {
    constexpr std::string_view own = at<I>(signals_of<T>).name;
    std::array<char, sizeof(prefix.text) + own.size()> joined{};
    std::copy(own.begin(), own.end(), std::copy_n(prefix.text, sizeof(prefix.text) - 1, joined.begin()));
    return joined;
  }();
  template <std::size_t I>
  static constexpr auto renamed() {
    constexpr auto own = at<I>(signals_of<T>);
    using Value = typename decltype(own)::value_type;
    return Observed<Derived, Value>{name<I>.data(), own.member, own.unit, own.site, own.frame, own.sign, own.doc};
  }
  template <std::size_t... I>
  static constexpr auto signals(std::index_sequence<I...>) {
    return List{renamed<I>()...};
  }
};

}  // namespace detail

/// The signals of `T` as a part of a record that derives from it, each name after `prefix`. So a record may hold two
/// parts of one type: what a site received and what it sent. Its members are those of `T`, whatever these are called.
template <class T, FixedText prefix>
struct Part : T {
  static constexpr auto signals() {
    return detail::PartOf<Part, T, prefix>::signals(std::make_index_sequence<decltype(T::signals())::size()>());
  }
};

}  // namespace tactus
