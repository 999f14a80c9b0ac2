// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/gain_change.hpp>
#include <tactus/runtime/servo/site_command.hpp>

#include <optional>

namespace tactus::cli {

/// What an operator may set at the leader's site, by its force gain as made and by `supervision.force_gain` of the
/// file. The errors are those of `GainChange::make`, which whoever makes the site reports too.
inline Result<runtime::Settable> settable_of(std::optional<double> force_gain,
                                             const control::GainChange::Params& params, Seconds tick, bool tares) {
  const auto gain = control::GainChange::make(params, force_gain, tick);
  if (!gain) return gain.error();
  runtime::Settable settable{.file_force_gain = gain->gain(), .tares = tares};
  if (gain->changes()) settable.most_force_gain = gain->limit();
  return settable;
}

}  // namespace tactus::cli
