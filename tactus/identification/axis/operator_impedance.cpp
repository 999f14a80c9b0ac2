// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/operator_impedance.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/identification/axis/zero_phase.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/root_mean_square.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Core>

namespace tactus::identification {
namespace {

constexpr std::size_t blocks_of_window = 8;
constexpr std::size_t blocks_between_windows = 2;
constexpr double default_upper_Hz = 80.0;
constexpr double least_explained = 0.5;
constexpr double periods_of_window = 10.0;
constexpr double slow_share = 0.25;    // of the band's lower edge: where people move
constexpr double taken_slowly = -0.1;  // correlation of force and velocity there; a hand that moves the device has > 0
constexpr double quicker = 1.25;  // force over position: from this ratio of quickness on the other way round, swapped

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

Error out_of_bounds(const char* option, std::string message) {
  return {ErrorCode::out_of_bounds, option, std::move(message), {}};
}

struct Band {
  double lower_Hz, upper_Hz;
};

/// The low-pass taken off twice, so that what people intend, which is far larger than the band's motion, stays out.
Result<std::vector<double>> band_pass(std::span<const double> samples, Band band, Seconds dt) {
  auto passed = zero_phase_low_pass(samples, band.upper_Hz, dt);
  for (int pass = 0; pass < 2 && passed; ++pass) {
    const auto slow = zero_phase_low_pass(*passed, band.lower_Hz, dt);
    if (!slow) return slow.error();
    std::transform(passed->begin(), passed->end(), slow->begin(), passed->begin(), std::minus<>());
  }
  return passed;
}

/// The first derivative by central differences of sixth order, whose error at a tenth of the sample rate is 0.05 %,
/// where that of second order is 6 %. Zero within three samples of the ends, which no block reaches.
std::vector<double> derivative(std::span<const double> samples, Seconds dt) {
  std::vector<double> slope(samples.size());
  for (std::size_t i = 3; i + 3 < samples.size(); ++i) {
    slope[i] = (45.0 * (samples[i + 1] - samples[i - 1]) - 9.0 * (samples[i + 2] - samples[i - 2]) +
                (samples[i + 3] - samples[i - 3])) /
               (60.0 * dt.value);
  }
  return slope;
}

struct Motion {
  std::vector<double> acceleration, velocity, position;
};

Result<Motion> motion_of(std::span<const double> position, Band band, Seconds dt) {
  auto passed = band_pass(position, band, dt);
  if (!passed) return passed.error();
  Motion motion{.acceleration = {}, .velocity = derivative(*passed, dt), .position = *std::move(passed)};
  motion.acceleration = derivative(motion.velocity, dt);
  return motion;
}

/// Sums over a block of samples: what a fit needs of it. y is the force on the hand, Z the instruments, R the
/// regressors, all in the order acceleration, velocity, position.
struct Sums {
  Matrix instruments_regressors = Matrix::Zero();
  Vector instruments_force = Vector::Zero();
  Matrix regressors_regressors = Matrix::Zero();
  Vector regressors_force = Vector::Zero();
  double force_force = 0;
  double samples = 0;

  void add(const Sums& other, double times) {
    instruments_regressors += times * other.instruments_regressors;
    instruments_force += times * other.instruments_force;
    regressors_regressors += times * other.regressors_regressors;
    regressors_force += times * other.regressors_force;
    force_force += times * other.force_force;
    samples += times * other.samples;
  }
};

struct Problem {
  std::vector<Sums> blocks;
  std::size_t first = 0;  ///< sample with which the first block begins
  std::size_t size = 0;   ///< samples of a block
  double dt_s = 0;
  double centre_rad_per_s = 0;  ///< scales velocity and acceleration, so that sums are of similar size
  double resolution = 0;        ///< smallest step of the position that occurs
};

Result<Problem> prepare(const AxisSignals& signals, Band band, double window_s) {
  const Seconds dt = signals.sample_time;
  const auto force = band_pass(every_second(signals.force, 0), band, dt);
  const auto even = motion_of(every_second(signals.position, 0), band, dt);
  const auto odd = motion_of(every_second(signals.position, 1), band, dt);
  if (!force || !even || !odd) return inconsistent("the recording could not be filtered: choose another band");
  Problem problem;
  problem.dt_s = dt.value;
  problem.first =
      static_cast<std::size_t>(1.0 / (band.lower_Hz * dt.value));  // the filter has to guess beyond the ends
  problem.size = static_cast<std::size_t>(std::lround(window_s / dt.value)) / blocks_of_window;
  problem.centre_rad_per_s = 2.0 * std::numbers::pi * std::sqrt(band.lower_Hz * band.upper_Hz);
  const double w = problem.centre_rad_per_s;
  const auto row = [w](const Motion& motion, std::size_t i) {
    return Vector(motion.acceleration[i] / (w * w), motion.velocity[i] / w, motion.position[i]);
  };
  const std::size_t end = signals.position.size() - std::min(problem.first, signals.position.size());
  for (std::size_t begin = problem.first; begin + problem.size <= end; begin += problem.size) {
    Sums sums;
    for (std::size_t i = begin; i < begin + problem.size; ++i) {
      const Vector r = row(*even, i);
      const Vector z = row(*odd, i);
      const double y = -(*force)[i];
      sums.instruments_regressors += z * r.transpose();
      sums.instruments_force += z * y;
      sums.regressors_regressors += r * r.transpose();
      sums.regressors_force += r * y;
      sums.force_force += y * y;
    }
    sums.samples = static_cast<double>(problem.size);
    problem.blocks.push_back(sums);
  }
  problem.resolution = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < signals.position.size(); ++i) {
    const double step = std::abs(signals.position[i] - signals.position[i - 1]);
    if (step > 0.0) problem.resolution = std::min(problem.resolution, step);
  }
  return problem;
}

/// No value where the motion does not span acceleration, velocity and position.
std::optional<Vector> solve(const Sums& sums) {
  const signal::Regression found = signal::regress(sums.instruments_regressors, sums.instruments_force, 1e-9);
  if (found.idle) return std::nullopt;
  return Vector(found.x);
}

/// The two-sided 95 % point of Student's t, within 1e-3 from seven degrees of freedom on (Cornish and Fisher's
/// expansion; Abramowitz and Stegun, 26.7.5).
double student_95(double freedom) {
  constexpr double z = 1.959963985;
  const double z2 = z * z;
  const double first = z * (z2 + 1.0) / 4.0;
  const double second = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
  const double third = z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
  return z + (first + (second + third / freedom) / freedom) / freedom;
}

ImpedanceVerdict judge(const Problem& problem, const Sums& sums, const OperatorImpedance& found) {
  if (std::sqrt(sums.regressors_regressors(2, 2) / sums.samples) < problem.resolution) return ImpedanceVerdict::still;
  if (sums.regressors_force[1] < 0.0) return ImpedanceVerdict::hand_drives;
  if (found.explained < least_explained) return ImpedanceVerdict::unexplained;
  const auto below_zero = [](const Estimate& parameter) { return parameter.upper < 0.0; };
  if (below_zero(found.stiffness) || below_zero(found.damping) || below_zero(found.mass)) {
    return ImpedanceVerdict::contradicted;
  }
  return ImpedanceVerdict::determined;
}

OperatorImpedance fit(const Problem& problem, std::size_t first, std::size_t count) {
  const std::span blocks = std::span(problem.blocks).subspan(first, count);
  OperatorImpedance found;
  found.from_s = static_cast<double>(problem.first + first * problem.size) * problem.dt_s;
  found.to_s = found.from_s + static_cast<double>(count * problem.size) * problem.dt_s;
  Sums all;
  for (const Sums& block : blocks) all.add(block, 1.0);
  const auto parameters = solve(all);
  if (!parameters) return found;
  Vector squares = Vector::Zero();
  for (const Sums& block : blocks) {
    Sums rest = all;
    rest.add(block, -1.0);
    const auto without = solve(rest);
    if (!without) return found;
    squares += (*without - *parameters).cwiseAbs2();
  }
  const double freedom = static_cast<double>(count - 1);
  const Vector half = student_95(freedom) * (squares * (freedom / static_cast<double>(count))).cwiseSqrt();
  const auto estimate = [&](Eigen::Index k, double scale) {
    const double value = (*parameters)[k] / scale;
    return Estimate{.value = value, .lower = value - half[k] / scale, .upper = value + half[k] / scale};
  };
  const double w = problem.centre_rad_per_s;
  found.mass = estimate(0, w * w);
  found.damping = estimate(1, w);
  found.stiffness = estimate(2, 1.0);
  const double left = all.force_force - 2.0 * parameters->dot(all.regressors_force) +
                      parameters->dot(all.regressors_regressors * *parameters);
  found.explained = all.force_force > 0.0 ? 1.0 - left / all.force_force : 0.0;
  found.verdict = judge(problem, all, found);
  return found;
}

/// Correlation of force and velocity where people move: positive for a hand that moves the device; 0 where nothing
/// moves.
double slow_work(const AxisSignals& signals, double upper_Hz) {
  const auto position = zero_phase_low_pass(signals.position, upper_Hz, signals.sample_time);
  auto force = zero_phase_low_pass(signals.force, upper_Hz, signals.sample_time);
  if (!position || !force) return 0.0;
  const auto count = static_cast<double>(force->size());
  const double mean = std::accumulate(force->begin(), force->end(), 0.0) / count;
  for (double& value : *force) value -= mean;
  const auto velocity = derivative(*position, signals.sample_time);
  const double scale = signal::root_mean_square(*force) * signal::root_mean_square(velocity);
  const double power = std::inner_product(force->begin(), force->end(), velocity.begin(), 0.0) / count;
  return scale > 0.0 ? power / scale : 0.0;
}

/// How fast a signal changes within the band [1/s]. A passive hand's force changes at least as fast as its motion.
double quickness(const std::vector<double>& samples, Band band, Seconds dt) {
  const auto passed = band_pass(samples, band, dt);
  if (!passed) return 0.0;
  return signal::root_mean_square(derivative(*passed, dt)) / signal::root_mean_square(*passed);
}

bool look_swapped(const AxisSignals& signals, Band band, double window_s) {
  const AxisSignals swapped{.position = signals.force, .force = signals.position, .sample_time = signals.sample_time};
  const double of_force = quickness(swapped.force, band, swapped.sample_time);
  const double of_position = quickness(swapped.position, band, swapped.sample_time);
  if (of_force < quicker * of_position) return false;
  const auto problem = prepare(swapped, band, window_s);
  return problem && fit(*problem, 0, problem->blocks.size()).verdict == ImpedanceVerdict::determined;
}

Check check_plausible(const AxisSignals& signals, const OperatorImpedances& found, bool doubt_sign) {
  if (found.whole.verdict != ImpedanceVerdict::determined &&
      look_swapped(signals, {found.lower_Hz, found.upper_Hz}, found.window_s)) {
    return inconsistent(
        "position and force look swapped: the other way round they show a passive hand; exchange --position and "
        "--force");
  }
  const double slow_Hz = slow_share * found.lower_Hz;
  const double work = slow_work(signals, slow_Hz);
  if (work > taken_slowly || !(doubt_sign || found.whole.verdict == ImpedanceVerdict::hand_drives)) return std::nullopt;
  return inconsistent(
      "below " + report::number(slow_Hz, 2) +
      " Hz the hand takes energy from the device (correlation of force and velocity " + report::number(work, 2) +
      "), but an operator who moves a device gives it: the force of the hand on the device counts toward "
      "+position, so turn it with --force-sign -1, or exchange --position and --force if they are "
      "swapped; if the device really moved a resting hand, write --force-sign 1");
}

Result<Band> band_of(const AxisSignals& signals, const OperatorImpedanceOptions& options) {
  const double rate_Hz = 1.0 / signals.sample_time.value;
  const double most_Hz = 0.2 * rate_Hz;
  const Band band{options.lower_Hz, options.upper_Hz.value_or(std::min(default_upper_Hz, 0.1 * rate_Hz))};
  if (!(band.lower_Hz >= 1.0 && band.lower_Hz <= 50.0)) {
    return out_of_bounds("lower_Hz", "the lower edge of the band is " + report::number(band.lower_Hz, 3) +
                                         " Hz: it must be from 1 to 50 Hz, and above intended motion");
  }
  if (!(band.upper_Hz >= 3.0 * band.lower_Hz && band.upper_Hz <= most_Hz)) {
    return out_of_bounds("upper_Hz", "the upper edge of the band is " + report::number(band.upper_Hz, 3) +
                                         " Hz: it must be from three times the lower edge (" +
                                         report::number(3.0 * band.lower_Hz, 3) +
                                         " Hz) to a fifth of the sample rate (" + report::number(most_Hz, 3) + " Hz)");
  }
  return band;
}

}  // namespace

bool OperatorImpedance::determined(const Estimate& parameter) const {
  return verdict == ImpedanceVerdict::determined && parameter.lower > 0.0;
}

Result<OperatorImpedances> estimate_operator_impedance(const AxisSignals& signals,
                                                       const OperatorImpedanceOptions& options) {
  if (auto error = check_axis(signals)) return *std::move(error);
  const auto band = band_of(signals, options);
  if (!band) return band.error();
  const double shortest_s = periods_of_window / band->lower_Hz;
  if (!(options.window_s >= shortest_s && options.window_s <= 600.0)) {
    return out_of_bounds("window_s", "a window of " + report::number(options.window_s, 3) +
                                         " s: it must be from ten periods of the band's lower edge (" +
                                         report::number(shortest_s, 3) + " s) to 600 s");
  }
  const auto problem = prepare(signals, *band, options.window_s);
  if (!problem) return problem.error();
  if (problem->blocks.size() < blocks_of_window) {
    return inconsistent("the recording is too short to judge: " +
                        report::number(static_cast<double>(signals.position.size()) * signals.sample_time.value, 3) +
                        " s; it takes a window of " + report::number(options.window_s, 3) +
                        " s and a period of the band's lower edge at both ends");
  }
  OperatorImpedances found;
  found.lower_Hz = band->lower_Hz;
  found.upper_Hz = band->upper_Hz;
  found.window_s = static_cast<double>(problem->size * blocks_of_window) * signals.sample_time.value;
  found.whole = fit(*problem, 0, problem->blocks.size());
  for (std::size_t first = 0; first + blocks_of_window <= problem->blocks.size(); first += blocks_between_windows) {
    found.windows.push_back(fit(*problem, first, blocks_of_window));
  }
  if (auto error = check_plausible(signals, found, options.doubt_sign)) return *std::move(error);
  return found;
}

}  // namespace tactus::identification
