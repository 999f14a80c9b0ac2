// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Just enough reading of markup and paths to check what the report module writes, without its help.
namespace tactus::report {

/// Empty when `document` is well-formed XML as far as tags, attributes and references go; else what is wrong.
std::string fault_of(std::string_view document);

/// The start tags named `name` whose text contains `with`, in order.
std::vector<std::string> tags(std::string_view document, std::string_view name, std::string_view with = "");

/// The value of an attribute of a start tag, or an empty text.
std::string attribute(std::string_view tag, std::string_view name);

/// The text contents of all `<text>` elements with the given class, in order.
std::vector<std::string> texts(std::string_view document, std::string_view style);

struct Position {
  double x, y;
};

/// The strokes of path data made of `M x y` and relative `l dx dy ...`, as absolute positions.
std::vector<std::vector<Position>> strokes(const std::string& data);

}  // namespace tactus::report
