#include <tactus/core/parameters.hpp>
#include <tactus/recording/time_base.hpp>

#include <array>
#include <charconv>
#include <cmath>

namespace tactus::recording {
namespace {

/// The number that ten digits of `value` say.
double without_rounding(double value) {
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 9);
  double shorter = value;
  std::from_chars(text.data(), written.ptr, shorter);
  return shorter;
}

}  // namespace

Result<double> uniform_sample_time(std::span<const double> time_s,
                                   const std::function<std::string(std::size_t)>& place_of) {
  constexpr double tolerated_share = 0.1;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (time_s[i] > time_s[i - 1]) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "time",
                 .message = "time does not increase: " + format_number(time_s[i - 1]) + " s is followed by " +
                            format_number(time_s[i]) + " s; remove the doubled samples or write times with more digits",
                 .place = place_of(i)};
  }
  const double sample_time_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double expected_s = time_s.front() + static_cast<double>(i) * sample_time_s;
    if (std::abs(time_s[i] - expected_s) <= tolerated_share * sample_time_s) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "time",
                 .message = "time is not uniform: sample " + std::to_string(i + 1) + " is at " +
                            format_number(time_s[i]) + " s, but a mean step of " + format_number(sample_time_s) +
                            " s puts it at " + format_number(expected_s) +
                            " s; fill lost samples or resample the recording to a uniform rate",
                 .place = place_of(i)};
  }
  return without_rounding(sample_time_s);
}

Result<std::optional<double>> agree(std::optional<double> stated_s, std::optional<double> found_s) {
  if (!stated_s || !found_s) return stated_s ? stated_s : found_s;
  constexpr double tolerated_share = 1e-3;
  if (std::abs(*stated_s - *found_s) <= tolerated_share * *stated_s) return stated_s;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "sample_time_s",
               .message = "a sample time of " + format_number(*stated_s) + " s contradicts the times in the file, " +
                          format_number(*found_s) + " s apart; correct it or leave it out",
               .place = {}};
}

}  // namespace tactus::recording
