// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

namespace tactus::cli {

/// Whether the other end of a pipe was closed, as `head` does once it has what it wants.
bool reader_is_gone(int descriptor);

/// An error unless all that was printed so far has reached its place. A reader that went away has had what it wanted:
/// that is no error.
Check flush_standard_output();

}  // namespace tactus::cli
