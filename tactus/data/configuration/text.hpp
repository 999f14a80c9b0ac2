// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>

namespace tactus::configuration {

/// The parts as one text.
std::string concat(std::initializer_list<std::string_view> parts);

/// A TOML basic string, quotes included. UTF-8 in, UTF-8 out.
std::string toml_string(std::string_view text);

/// A TOML float that reads back bit for bit: it always has a point or an exponent, so that it stays a float and keeps
/// the sign of zero.
std::string toml_float(double value);

/// True for a key that TOML writes without quotes.
bool is_bare_key(std::string_view key);

/// `text` fit for a one-line message: control characters escaped, cut at about `longest` bytes.
std::string printable(std::string_view text, std::size_t longest = 80);

/// `text` without spaces and tabs at its ends.
std::string_view trimmed(std::string_view text);

}  // namespace tactus::configuration
