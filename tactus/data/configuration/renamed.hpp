// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace tactus::configuration {

/// The present name of a key that had another one, `reply_timeout_s` for `patience_s`; empty for any other key. `key`
/// is the last part of a path. Such a key is refused with its new name, never read.
std::string_view new_name_of(std::string_view key);

}  // namespace tactus::configuration
