#pragma once

#include <tactus/core/result.hpp>

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
/// times, too little for a lost or a doubled sample. `place_of(row)` says where a sample stands, for the error.
Result<double> uniform_sample_time(std::span<const double> time_s,
                                   const std::function<std::string(std::size_t)>& place_of);

/// The sample time in seconds from what was stated and what was found in the file, either of which may be absent. Where
/// both are there, they must agree within one part in a thousand, and the stated one, which no printing has rounded,
/// counts.
Result<std::optional<double>> agree(std::optional<double> stated_s, std::optional<double> found_s);

}  // namespace tactus::recording
