#pragma once

#include <tactus/core/result.hpp>

#include <string>
#include <utility>

namespace tactus::identification {

/// The data do not fit what is asked of them: says why, and what to do.
inline Error inconsistent(std::string message) { return {ErrorCode::inconsistent, {}, std::move(message), {}}; }

}  // namespace tactus::identification
