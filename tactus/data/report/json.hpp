// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace tactus::report {

// Results as JSON. `Json` is nlohmann::ordered_json, for which alone these are in the library: whoever instantiates
// its writer and reader takes a second longer to compile, and whoever includes this header does not need that library.

/// A document as a file or a terminal gets it: two blanks a level, and a line break at the end. Names in it may come
/// from anywhere: what is not UTF-8 is replaced by U+FFFD, what is not finite by null.
template <class Json>
std::string json_text(const Json& document);

/// The same in one line without a break, for other documents to take in.
template <class Json>
std::string json_line(const Json& value);

/// What `text` states, discarded (`is_discarded()`) where it is no JSON. Does not throw.
template <class Json>
Json parse_json(std::string_view text);

}  // namespace tactus::report
