// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace tactus {

/// The version of the library, as in `find_package(tactus 0.1)`.
std::string_view version();

}  // namespace tactus
