// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

/// A parameter struct with its type erased: its keys, for code that is compiled once for all structs. Cold: it
/// allocates.
namespace tactus {

/// Marks a binding that is a group of further keys and holds no value of its own.
struct Section {};

/// One enum member, its type erased: the words a file may use, and how to read and write the member by word.
struct Choice {
  std::vector<std::string_view> words;
  void* member;
  std::string_view (*word_of)(const void* member);
  /// `index` counts in `words`.
  void (*assign)(void* member, std::size_t index);
};

/// One key of a parameter struct: what the loader, the schema, the reference page and the errors need to know about it,
/// and where its value is stored.
struct Binding {
  std::string path;  ///< dotted: `slave.friction.force_N`
  Unit unit;
  Bounds bounds;
  std::string doc;
  std::variant<Section, double*, std::int64_t*, bool*, std::string*, Choice> target;

  [[nodiscard]] bool is_section() const { return std::holds_alternative<Section>(target); }
};

/// `slave.friction` and `force_N` make `slave.friction.force_N`; either may be empty.
std::string join(std::string_view section, std::string_view key);
/// The part of a dotted path before its last dot, or nothing.
std::string_view section_of(std::string_view path);
/// The part of a dotted path after its last dot.
std::string_view key_of(std::string_view path);

/// A member of a parameter struct whose keys only a running program knows, such as those of what was plugged in. With
/// an empty name its field puts them alongside those of the other fields.
template <class T>
concept OpenGroup = CheckedGroup<T> && requires(T& group, std::string_view section, std::vector<Binding>& bindings) {
  group.append_to(bindings, section);
};

namespace detail {

template <NamedEnum E>
Choice choice_of(E& member) {
  Choice choice{.words = {},
                .member = &member,
                .word_of = [](const void* from) -> std::string_view { return name_of(*static_cast<const E*>(from)); },
                .assign = [](void* to, std::size_t index) { *static_cast<E*>(to) = enumerators(E{})[index].value; }};
  for (const auto& entry : enumerators(E{})) choice.words.emplace_back(entry.name);
  return choice;
}

/// Adds one key below `section`. Out of line, since every key of every struct is added by such a call.
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, double* target);
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, std::int64_t* target);
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, bool* target);
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, std::string* target);
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, Choice target);
/// A group, which holds no value of its own.
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key);
/// The groups that `section` lies in and itself, the outermost first.
std::vector<Binding> sections_down_to(std::string_view section, const char* doc);

}  // namespace detail

/// Adds every key of `params`, in the order of its description, below `section`.
template <Described T>
void append_bindings(T& params, std::string_view section, std::vector<Binding>& bindings) {
  for_each_field<T>([&](const auto& f) {
    auto& member = params.*f.member;
    using Value = std::remove_cvref_t<decltype(member)>;
    if constexpr (OpenGroup<Value>) {
      member.append_to(bindings, join(section, f.name));
    } else if constexpr (Described<Value>) {
      detail::append(bindings, section, f);
      append_bindings(member, join(section, f.name), bindings);
    } else if constexpr (NamedEnum<Value>) {
      detail::append(bindings, section, f, detail::choice_of(member));
    } else {
      detail::append(bindings, section, f, &member);
    }
  });
}

/// Every key of `params` in the order of its description, a section before its members.
///
/// With `section`, all keys lie below that section, so that one document can fill several structs. The bindings point
/// into `params` and are good only as long as it stays where it is.
template <Described T>
std::vector<Binding> bind(T& params, std::string_view section = {}, const char* section_doc = "") {
  std::vector<Binding> bindings = detail::sections_down_to(section, section_doc);
  append_bindings(params, section, bindings);
  return bindings;
}

}  // namespace tactus
