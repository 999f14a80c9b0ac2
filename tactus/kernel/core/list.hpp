// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>

namespace tactus {

namespace detail {

template <std::size_t index, class T>
struct Listed {
  T value;
};

template <class Indices, class... T>
struct ListOf;

template <std::size_t... index, class... T>
struct ListOf<std::index_sequence<index...>, T...> : Listed<index, T>... {
  constexpr explicit ListOf(T... values) : Listed<index, T>{values}... {}

  template <class Visit>
  constexpr void for_each(Visit&& visit) const {
    (visit(static_cast<const Listed<index, T>&>(*this).value), ...);
  }
  template <class Visit>
  constexpr decltype(auto) apply(Visit&& visit) const {
    return visit(static_cast<const Listed<index, T>&>(*this).value...);
  }
};

template <std::size_t index, class T>
constexpr const T& at(const Listed<index, T>& listed) {
  return listed.value;
}

}  // namespace detail

/// Values of different types in order: a std::tuple that takes a compiler a fraction of the time, since it can do
/// little more than be gone through. Every parameter struct and every record is described by one.
template <class... T>
struct List : detail::ListOf<std::index_sequence_for<T...>, T...> {
  constexpr explicit List(T... values) : detail::ListOf<std::index_sequence_for<T...>, T...>(values...) {}

  static constexpr std::size_t size() { return sizeof...(T); }
};

/// That at a place, from 0.
template <std::size_t index, class... T>
constexpr const auto& at(const List<T...>& list) {
  return detail::at<index>(list);
}

/// The values of all lists, in order.
template <class... T>
constexpr List<T...> joined(const List<T...>& list) {
  return list;
}
template <class... T, class... U, class... Lists>
constexpr auto joined(const List<T...>& first, const List<U...>& second, const Lists&... others) {
  return joined(first.apply([&second](const T&... of_first) {
    return second.apply([&of_first...](const U&... of_second) { return List<T..., U...>(of_first..., of_second...); });
  }),
                others...);
}

}  // namespace tactus
