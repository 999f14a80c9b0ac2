// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/version.hpp>

namespace tactus {

std::string_view version() { return TACTUS_VERSION; }

}  // namespace tactus
