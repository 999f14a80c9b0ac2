// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/checks.hpp>

namespace tactus::signal {

Check check_sample_time(Seconds dt) {
  if (positive.contain(dt.value)) return {};
  return out_of_bounds("dt", dt.value, positive, units::second);
}

Check check_below_nyquist(std::string_view parameter, double frequency_Hz, Seconds dt) {
  const double nyquist_Hz = 0.5 / dt.value;
  if (frequency_Hz < nyquist_Hz) return {};
  return Error{.code = ErrorCode::inconsistent,
               .parameter = std::string(parameter),
               .message = rounded_number(frequency_Hz) + " Hz must lie below half the sample rate, " +
                          rounded_number(nyquist_Hz) + " Hz at a sample time of " + rounded_number(dt.value) +
                          " s: lower the frequency or sample faster",
               .place = {}};
}

}  // namespace tactus::signal
