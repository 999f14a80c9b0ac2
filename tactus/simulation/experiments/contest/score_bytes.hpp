// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/contest/contest.hpp>

#include <string>
#include <string_view>

/// Pieces of a competitor's score as bytes, with all bits of their numbers: values of tasks.
namespace tactus::experiments {

std::string to_bytes(const GainLimit& limit);
std::string to_bytes(const GainScore& score);
std::string to_bytes(const FreeSpaceScore& score);

/// Each returns whether the bytes are such a piece.
bool from_bytes(std::string_view bytes, GainLimit& limit);
bool from_bytes(std::string_view bytes, GainScore& score);
bool from_bytes(std::string_view bytes, FreeSpaceScore& score);

}  // namespace tactus::experiments
