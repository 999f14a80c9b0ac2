// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/frequency_response.hpp>
#include <tactus/identification/diagnosis/following.hpp>
#include <tactus/identification/diagnosis/oscillation.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace tactus::diagnosis {

namespace {

constexpr std::size_t lag_blocks = 8;
constexpr double student_of_blocks = 2.365;  ///< two-sided, seven degrees of freedom
constexpr double earliest_s = -0.1, latest_s = 0.5, least_together = 0.9;

/// Motion over about 50 ms, at 1 kHz at most.
struct Motion {
  std::vector<double> leader = {}, follower = {};
  double step_s = 0.0;
};

Motion motion_of(const Signals& signals) {
  constexpr double shortest_step_s = 1e-3, over_s = 0.05;
  const double dt_s = signals.sample_time.value;
  const auto every = std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(shortest_step_s / dt_s)));
  const auto over = std::max<std::size_t>(1, static_cast<std::size_t>(over_s / dt_s));
  Motion motion{.step_s = static_cast<double>(every) * dt_s};
  const auto leader = signals.values(Role::master_position), follower = signals.values(Role::slave_position);
  for (std::size_t i = over; i < signals.samples; i += every) {
    motion.leader.push_back(leader[i] - leader[i - over]);
    motion.follower.push_back(follower[i] - follower[i - over]);
  }
  return motion;
}

struct Sums {
  double leader = 0.0, follower = 0.0, both = 0.0;
};

/// The lag of the largest correlation, a parabola through the three largest; `left_out`: this block is not counted.
std::pair<double, double> peak_of(const std::vector<std::array<Sums, lag_blocks>>& sums, std::size_t left_out,
                                  double sign) {
  std::vector<double> together;
  for (const auto& of_lag : sums) {
    Sums all;
    for (std::size_t b = 0; b < lag_blocks; ++b) {
      if (b == left_out) continue;
      all.leader += of_lag[b].leader, all.follower += of_lag[b].follower, all.both += of_lag[b].both;
    }
    const double size = std::sqrt(all.leader * all.follower);
    together.push_back(size > 0.0 ? sign * all.both / size : 0.0);
  }
  const auto top = static_cast<std::size_t>(std::max_element(together.begin(), together.end()) - together.begin());
  double at = static_cast<double>(top);
  if (top > 0 && top + 1 < together.size()) {
    const double before = together[top - 1], after = together[top + 1];
    const double bend = before - 2.0 * together[top] + after;
    if (bend < 0.0) at += 0.5 * (before - after) / bend;
  }
  return {at, together[top]};
}

using Line = std::complex<double>;

/// A frequency response where it is known, relative to its scale.
struct Response {
  std::vector<double> turns;  ///< angular frequency [rad/s]
  std::vector<Line> value;
  std::vector<double> weight;  ///< 1 over the square of its uncertainty
};

struct Servo {
  double gain = 1.0, a = 0.0, b = 0.0;
  double left = 0.0;  ///< weighted squares
  [[nodiscard]] Line at(double turns) const {
    return gain / (1.0 + Line(0.0, a * turns) - Line(b * turns * turns, 0.0));
  }
};

/// g − a·(s·H) − b·(s²·H) = H for H without its delay, with `terms` of the three unknowns.
Servo fit_servo(const Response& response, double delay_s, std::size_t terms) {
  double normal[3][4] = {};
  for (std::size_t i = 0; i < response.turns.size(); ++i) {
    const Line s(0.0, response.turns[i]);
    const Line h = response.value[i] * std::exp(s * delay_s);
    // As if the error were that of the response itself: at high frequencies that is small, and so are its errors.
    const double weight = response.weight[i] * std::norm(response.value[i]);
    const std::array<Line, 4> row{Line(1.0, 0.0), -s * h, -s * s * h, h};
    for (std::size_t r = 0; r < terms; ++r) {
      for (std::size_t c = 0; c < 4; ++c) normal[r][c] += weight * (std::conj(row[r]) * row[c]).real();
    }
  }
  std::array<double, 3> found{};
  // Gaussian elimination; the matrix is symmetric and positive.
  for (std::size_t r = 0; r < terms; ++r) {
    for (std::size_t below = r + 1; below < terms; ++below) {
      const double factor = normal[r][r] > 0.0 ? normal[below][r] / normal[r][r] : 0.0;
      for (std::size_t c = 0; c < 4; ++c) normal[below][c] -= factor * normal[r][c];
    }
  }
  for (std::size_t r = terms; r-- > 0;) {
    double right = normal[r][3];
    for (std::size_t c = r + 1; c < terms; ++c) right -= normal[r][c] * found[c];
    found[r] = normal[r][r] > 0.0 ? right / normal[r][r] : 0.0;
  }
  Servo servo{.gain = found[0], .a = found[1], .b = found[2]};
  if (terms > 1 && (servo.a < 0.0 || servo.b < 0.0)) return fit_servo(response, delay_s, terms - 1);
  for (std::size_t i = 0; i < response.turns.size(); ++i) {
    const Line model = servo.at(response.turns[i]) * std::polar(1.0, -response.turns[i] * delay_s);
    servo.left += response.weight[i] * std::norm(response.value[i] - model);
  }
  return servo;
}

double bandwidth_of(const Servo& servo, double highest_Hz) {
  constexpr double half_power = 0.7071;
  const double step_Hz = highest_Hz / 4000.0;
  for (double f_Hz = step_Hz; f_Hz <= highest_Hz; f_Hz += step_Hz) {
    if (std::abs(servo.at(2.0 * std::numbers::pi * f_Hz)) < half_power * servo.gain) return f_Hz;
  }
  return 0.0;
}

/// The response from the lowest line on, as long as it is coherent.
Response response_of(const Signals& signals, double scale) {
  constexpr double segment_s = 3.0, coherent = 0.8;
  constexpr std::size_t longest_gap = 3;
  Response found;
  const auto samples = std::min(static_cast<std::size_t>(segment_s / signals.sample_time.value), signals.samples / 3);
  if (samples < 32) return found;
  const identification::InputOutput run{signals.values(Role::master_position), signals.values(Role::slave_position)};
  const auto spectra = identification::average_spectra({&run, 1}, signals.sample_time,
                                                       {.samples = static_cast<std::int64_t>(std::bit_floor(samples))});
  if (!spectra) return found;
  const auto response = identification::response_h1(*spectra);
  std::size_t gap = 0;
  for (std::size_t k = 1; k < response.frequency_Hz.size() && gap < longest_gap; ++k) {
    if (response.coherence[k] < coherent) {
      ++gap;
      continue;
    }
    gap = 0;
    const double size = std::abs(response.response[k]) / std::abs(scale);
    const double noise = (1.0 - response.coherence[k]) / response.coherence[k] * size * size;
    found.turns.push_back(2.0 * std::numbers::pi * response.frequency_Hz[k]);
    found.value.push_back(response.response[k] / scale);
    found.weight.push_back(1.0 / std::max(noise, 1e-6));
  }
  return found;
}

/// Separates the constant part of the lag from the servo, where the response determines it.
void separate(Following& following, const Response& response, Seconds dt) {
  constexpr std::size_t fewest_lines = 6, tried = 80;
  constexpr double nearly = 1.3, part = 0.2, of_a_sample = 0.25, further = 1.3;
  const double lag_s = following.lag_s.value;
  if (response.turns.size() < fewest_lines || !(lag_s > 0.0)) return;
  std::vector<Servo> fits;
  const double step_s = further * lag_s / static_cast<double>(tried - 1);
  for (std::size_t i = 0; i < tried; ++i) fits.push_back(fit_servo(response, step_s * static_cast<double>(i), 3));
  const auto best =
      std::min_element(fits.begin(), fits.end(), [](const Servo& a, const Servo& b) { return a.left < b.left; });
  const auto good = [&](const Servo& one) { return one.left <= nearly * best->left + 1e-9; };
  const auto first = std::find_if(fits.begin(), fits.end(), good);
  const auto last = std::find_if(fits.rbegin(), fits.rend(), good);
  const auto at = [&](auto it) { return step_s * static_cast<double>(it - fits.begin()); };
  const identification::Estimate constant{.value = at(best), .lower = at(first), .upper = at(std::prev(last.base()))};
  if (constant.upper - constant.lower > std::max(2.0 * part * lag_s, 2.0 * of_a_sample * dt.value)) return;
  following.constant_s = constant;
  const double bandwidth_Hz = bandwidth_of(*best, following.moves_to_Hz);
  if (bandwidth_Hz > 0.0) following.bandwidth_Hz = bandwidth_Hz;
}

std::string ms(double seconds) { return report::number(1e3 * seconds, 2) + " ms"; }

}  // namespace

std::optional<Following> find_following(const Signals& signals) {
  constexpr double least_counts = 10.0;
  const Channel* leader = signals.find(Role::master_position);
  const Channel* follower = signals.find(Role::slave_position);
  if (leader == nullptr || follower == nullptr || leader->constant() || follower->constant()) return std::nullopt;
  const Motion motion = motion_of(signals);
  const auto steps = [&](double seconds) { return static_cast<std::ptrdiff_t>(std::lround(seconds / motion.step_s)); };
  const auto count = static_cast<std::ptrdiff_t>(motion.leader.size());
  // Each lag is judged in the same stretch of the follower.
  const std::ptrdiff_t early = std::min(steps(-earliest_s), count / 8), late = std::min(steps(latest_s), count / 4);
  const double scale = position_scale(signals);
  std::vector<std::array<Sums, lag_blocks>> sums(static_cast<std::size_t>(early + late + 1));
  double leader_squares = 0.0, follower_squares = 0.0;
  const std::ptrdiff_t length = count - early - late;
  if (length < static_cast<std::ptrdiff_t>(10 * lag_blocks)) return std::nullopt;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const std::ptrdiff_t lag = static_cast<std::ptrdiff_t>(k) - early;
    for (std::ptrdiff_t i = late; i < count - early; ++i) {
      const double x = motion.leader[static_cast<std::size_t>(i - lag)];
      const double y = motion.follower[static_cast<std::size_t>(i)];
      Sums& into = sums[k][static_cast<std::size_t>((i - late) * static_cast<std::ptrdiff_t>(lag_blocks) / length)];
      into.leader += x * x, into.follower += y * y, into.both += x * y;
      if (lag == 0) leader_squares += x * x, follower_squares += y * y;
    }
  }
  const auto n = static_cast<double>(length);
  if (std::sqrt(leader_squares / n) < least_counts * leader->step) return std::nullopt;
  if (std::sqrt(follower_squares / n) < least_counts * follower->step) return std::nullopt;
  const double sign = scale < 0.0 ? -1.0 : 1.0;
  const auto [at, together] = peak_of(sums, lag_blocks, sign);
  if (together < least_together) return std::nullopt;
  const auto seconds = [&](double index) { return (index - static_cast<double>(early)) * motion.step_s; };
  double mean = 0.0, squares = 0.0;
  std::array<double, lag_blocks> without{};
  for (std::size_t b = 0; b < lag_blocks; ++b) {
    without[b] = seconds(peak_of(sums, b, sign).first);
    mean += without[b] / static_cast<double>(lag_blocks);
  }
  for (const double one : without) squares += (one - mean) * (one - mean);
  const double half = student_of_blocks * std::sqrt(squares * (lag_blocks - 1.0) / static_cast<double>(lag_blocks));
  Following following;
  following.lag_s = {.value = seconds(at), .lower = seconds(at) - half, .upper = seconds(at) + half};
  const Response response = response_of(signals, scale);
  if (!response.turns.empty()) following.moves_to_Hz = response.turns.back() / (2.0 * std::numbers::pi);
  separate(following, response, signals.sample_time);
  return following;
}

std::string text_of(const Following& following, const Signals& signals) {
  constexpr double low_rate_Hz = 100.0, a_part = 0.15;
  const double lag_s = following.lag_s.value, dt_s = signals.sample_time.value, rate_Hz = 1.0 / dt_s;
  constexpr double undetermined = 0.5;
  const double half_s = 0.5 * (following.lag_s.upper - following.lag_s.lower);
  if (half_s > std::max(undetermined * std::abs(lag_s), 2.0 * dt_s)) {
    return "By how much the follower lags cannot be determined: between " +
           report::number(1e3 * following.lag_s.lower, 2) + " and " + ms(following.lag_s.upper) +
           ". Record some seconds in which the operator leads in free motion and nothing oscillates.";
  }
  std::string text = "The follower moves " + ms(std::abs(lag_s)) + (lag_s < 0.0 ? " before" : " after") +
                     " the leader (95 %: " + report::number(1e3 * following.lag_s.lower, 2) + " to " +
                     ms(following.lag_s.upper) + ").";
  if (following.lag_s.upper < 0.0) {
    text += " Nothing follows before it is led: is the operator at the device that is called the follower?";
    return text;
  }
  if (following.constant_s) {
    const auto& constant = *following.constant_s;
    text += " Of this, " + ms(constant.value) + " (" + report::number(1e3 * constant.lower, 2) + " to " +
            ms(constant.upper) +
            ") are a constant delay (transport, buffers, computation), the rest is the follower's servo";
    text += following.bandwidth_Hz ? ", whose bandwidth is " + report::number(*following.bandwidth_Hz, 2) + " Hz."
                                   : ", whose bandwidth is above " + report::number(following.moves_to_Hz, 2) + " Hz.";
  } else if (lag_s > 0.0 && following.moves_to_Hz > 0.0) {
    text += " Whether that is a constant delay or the follower's servo cannot be determined: the leader moves up to " +
            report::number(following.moves_to_Hz, 2) + " Hz, where both look alike. Lead faster for some seconds.";
  }
  if (dt_s > a_part * std::abs(lag_s)) {
    text += " One sample is " + ms(dt_s) +
            ": if the control loop runs at the rate of the recording, holding each command " + "for one sample adds " +
            ms(0.5 * dt_s) + " to the lag, and computing it one cycle later " + ms(dt_s) + ".";
  }
  if (rate_Hz < low_rate_Hz) {
    text += " At " + report::number(rate_Hz, 2) + " samples a second the lag and motion below " +
            report::number(0.2 * rate_Hz, 2) + " Hz can be judged. What oscillates faster than " +
            report::number(0.5 * rate_Hz, 2) +
            " Hz appears as a slower motion or not at all, so it cannot be excluded.";
  }
  return text;
}

}  // namespace tactus::diagnosis
