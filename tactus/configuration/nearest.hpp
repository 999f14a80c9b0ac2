#pragma once

#include <tactus/configuration/binding.hpp>

#include <cstddef>
#include <span>
#include <string_view>

namespace tactus::configuration {

/// How many slips of the fingers lie between two words: letters missing, added, replaced, or swapped with their
/// neighbour. The case of a letter does not count. (Optimal string alignment distance.)
std::size_t slips(std::string_view a, std::string_view b);

/// The word that `given` was probably meant to be, at most one slip in three letters away; empty when none is near.
std::string_view nearest_word(std::string_view given, std::span<const std::string_view> words);

/// The path of the section, or of the value, that `given` was probably meant to be; empty when none is near. It counts
/// as near by its last part alone (a key in another section), by the whole path (`control_gain` for `control.gain`),
/// and without its unit.
std::string_view nearest_path(std::string_view given, bool is_section, std::span<const Binding> bindings);

}  // namespace tactus::configuration
