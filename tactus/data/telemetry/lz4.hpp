// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace tactus::telemetry {

/// Unpacks LZ4 frames into `into`, whose size is what they must hold. False for bytes that are no such frames, that
/// hold more or less, or that need a dictionary; checksums within are not looked at, since chunks have their own.
/// Source: LZ4 Frame Format 1.6.4 and LZ4 Block Format, https://github.com/lz4/lz4/tree/dev/doc.
bool unpack_lz4(std::string_view frames, std::string& into);

}  // namespace tactus::telemetry
