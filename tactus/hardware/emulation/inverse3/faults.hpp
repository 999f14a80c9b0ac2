// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace tactus::emulation::inverse3 {

/// What the states of an emulated device may report in place of what is so, and what it may do wrong.
enum class FaultKind : std::int64_t {
  mode,          ///< another mode, any word; the empty one leaves the mode out
  calibrated,    ///< 0 or 1; the device continues to give force
  power_supply,  ///< the same
  ready,         ///< the same
  keeps_force    ///< a message without a command does not end a force
};
constexpr auto enumerators(FaultKind) {
  return std::array{Enumerator{FaultKind::mode, "mode"}, Enumerator{FaultKind::calibrated, "calibrated"},
                    Enumerator{FaultKind::power_supply, "power_supply"}, Enumerator{FaultKind::ready, "ready"},
                    Enumerator{FaultKind::keeps_force, "keeps-force"}};
}

struct Fault {
  FaultKind kind = FaultKind::mode;
  std::string mode;          ///< that `FaultKind::mode` reports
  bool flag = false;         ///< that the flags report
  std::int64_t from_ns = 0;  ///< from when on
};

/// Reads `KIND[=VALUE][@SECONDS]`, as `mode=impedance@5`, `calibrated=0` or `keeps-force`. Errors: `syntax`, with the
/// text and what there is.
Result<Fault> parse_fault(std::string_view text);

}  // namespace tactus::emulation::inverse3
