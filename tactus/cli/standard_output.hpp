#pragma once

#include <tactus/core/result.hpp>

#include <iostream>

namespace tactus::cli {

/// An error unless all that was printed so far has reached its place.
inline Check flush_standard_output() {
  if (std::cout.flush()) return std::nullopt;
  return Error{.code = ErrorCode::unwritable,
               .parameter = {},
               .message = "the output could not be written: give it a place with room",
               .place = "standard output"};
}

}  // namespace tactus::cli
