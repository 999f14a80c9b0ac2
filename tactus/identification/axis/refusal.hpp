// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <string>
#include <utility>

namespace tactus::identification {

/// The data do not fit what is asked of them: states why, and what to do.
inline Error inconsistent(std::string message) { return {ErrorCode::inconsistent, {}, std::move(message), {}}; }
inline Error inconsistent(std::string parameter, std::string message) {
  return {ErrorCode::inconsistent, std::move(parameter), std::move(message), {}};
}

}  // namespace tactus::identification
