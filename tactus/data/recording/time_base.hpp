// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <functional>
#include <optional>
#include <span>
#include <string>

namespace tactus::recording {

/// The sample time of a time column, in seconds: its span divided by its number of steps, to ten digits, so that the
/// rounding of differences does not make 0.0004999999999999999 s of 0.0005 s.
///
/// `time_s` are finite times in seconds, at least two. They must increase strictly, and none may lie further than a
/// tenth of the sample time from the uniform grid through the first and the last: enough for the rounding of printed
/// times, too little for a lost or a doubled sample. `place_of(row)` states where a sample is, for the error.
Result<double> uniform_sample_time(std::span<const double> time_s,
                                   const std::function<std::string(std::size_t)>& place_of);

/// The rms distance of times from equal steps, in seconds, where no sample is lost or doubled: what a computer makes of
/// them that stamps samples when it comes to it. None where some step is a lost or doubled sample, where times do not
/// increase strictly, and where they leave equal steps by more than 0.45 of one. Slow changes of the rate do not count.
std::optional<double> jitter_of(std::span<const double> time_s);

/// Refuses a mean step in which no device of this kind is recorded (outside 2 us to 0.5 s): the times are in another
/// unit. The message states in which unit they would make sense. `unit_stated`: the file or the caller states the unit.
Check check_step(double sample_time_s, bool unit_stated);

/// By how much too long a step is, as a power of ten (1000 for times in ms that are taken for seconds, 1e-3 for the
/// reverse), which a velocity shows that was measured alongside the position. None where they agree or show nothing.
std::optional<double> step_is_too_long_by(std::span<const double> position, std::span<const double> velocity,
                                          double sample_time_s);

/// The refusal of such times.
Error contradicted_by_velocity(const std::string& velocity, double too_long_by, double sample_time_s);

/// The sample time in seconds from what was stated and what was found in the file, either of which may be absent. Where
/// both are there, they must agree within one part in a thousand, and the stated one, which no printing has rounded,
/// counts.
Result<std::optional<double>> agree(std::optional<double> stated_s, std::optional<double> found_s);

}  // namespace tactus::recording
