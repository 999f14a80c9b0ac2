// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

/// What a user probably meant: for errors that name the nearest word there is.
namespace tactus {

/// How many slips of the fingers lie between two words: letters missing, added, replaced, or swapped with their
/// neighbour. The case of a letter does not count. (Optimal string alignment distance.)
std::size_t slips(std::string_view a, std::string_view b);

/// How many slips make a misspelt `word` another word: more than one in three letters, and any in a word of two (`no`
/// does not mean `on`).
std::size_t most_slips(std::string_view word);

/// The slips between two words, or nothing when there are more than `most`. Words of very different length are not
/// compared letter by letter: a hostile key may be a million letters long.
std::optional<std::size_t> slips_up_to(std::size_t most, std::string_view a, std::string_view b);

/// The word that `given` was probably meant to be; empty when none is near.
std::string_view nearest_word(std::string_view given, std::span<const std::string_view> words);

}  // namespace tactus
