// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <string_view>

/// What every `make` of an element has to ask. Cold: these build strings.
namespace tactus::signal {

/// An error naming `dt` unless the sample time is positive and finite.
Check check_sample_time(Seconds dt);

/// An error naming `parameter` unless `frequency_Hz` lies below half the sample rate `1 / dt`.
Check check_below_nyquist(std::string_view parameter, double frequency_Hz, Seconds dt);

/// The bounds of every field, then the sample time.
template <Described Params>
Check check(const Params& params, Seconds dt) {
  if (Check error = validate(params)) return error;
  return check_sample_time(dt);
}

}  // namespace tactus::signal
