// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/motion.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/identification/axis/zero_phase.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <span>

namespace tactus::arm_identification {
namespace {

using identification::central_difference;
using identification::inconsistent;
using identification::zero_phase_low_pass;

constexpr double fast_factor = 4.0;         ///< of the cutoff: what friction's turning round is seen with
constexpr double fast_rate_factor = 16.0;   ///< of the cutoff: rate at which that is kept
constexpr Eigen::Index window_rows = 4096;  ///< of a law of the whole motion, for its memory
constexpr double window_margin = 3.0;       ///< periods of the cutoff, in which a filter forgets how it began
constexpr double most_disagreement = 0.5;   ///< of a velocity with the slope of its position

std::string short_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

double rms(std::span<const double> values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(std::max<std::size_t>(1, values.size())));
}

double rms_apart(std::span<const double> a, std::span<const double> b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, a.size())));
}

/// Every `stride`-th value.
std::vector<double> every(const std::vector<double>& values, std::size_t stride) {
  std::vector<double> kept;
  kept.reserve(values.size() / stride + 1);
  for (std::size_t i = 0; i < values.size(); i += stride) kept.push_back(values[i]);
  return kept;
}

/// The slope by central differences of sixth order, of second at the ends: that of second alone makes a slope at a
/// tenth of the sample rate 6 % too small.
std::vector<double> slope_of(const std::vector<double>& samples, Seconds dt) {
  std::vector<double> slope = central_difference(samples, dt);
  for (std::size_t i = 3; i + 3 < samples.size(); ++i) {
    slope[i] = (45.0 * (samples[i + 1] - samples[i - 1]) - 9.0 * (samples[i + 2] - samples[i - 2]) + samples[i + 3] -
                samples[i - 3]) /
               (60.0 * dt.value);
  }
  return slope;
}

/// What one joint did, below the fast cutoff and at its rate.
struct Filtered {
  std::vector<double> position, velocity, acceleration, effort;
};

/// How far a measured velocity lies from a slope, as a share of the slope.
double disagreement(std::span<const double> measured, std::span<const double> slope) {
  const double size = rms(slope);
  return size > 0.0 ? rms_apart(measured, slope) / size : 1e9;
}

Error wrong_velocity(const ArmRecording& recording, std::size_t joint, const std::string& name,
                     const std::vector<double>& measured, const std::vector<std::vector<double>>& slopes) {
  std::string remedy = "name the columns in the order of the joints, in rad/s";
  const auto fits = std::find_if(slopes.begin(), slopes.end(), [&](const std::vector<double>& slope) {
    return disagreement(measured, slope) < most_disagreement;
  });
  if (fits != slopes.end()) {
    remedy = "it is that of '" + recording.position_names[static_cast<std::size_t>(fits - slopes.begin())] +
             "': are columns swapped?";
  }
  return inconsistent("velocity", "the velocity of joint '" + name + "' is not the slope of its position '" +
                                      recording.position_names[joint] + "': it differs by " +
                                      short_number(100.0 * disagreement(measured, slopes[joint])) + " % of it; " +
                                      remedy);
}

}  // namespace

Result<ArmMotion> ArmMotion::make(const ArmRecording& recording, double cutoff_Hz, double rows_per_s,
                                  const std::vector<std::string>& joints, JointsThatMove moving) {
  const Seconds dt = recording.sample_time;
  const auto fail = [&](Error error) {
    if (error.place.empty()) error.place = recording.file.string();
    return error;
  };
  const double duration_s = dt.value * static_cast<double>(recording.samples());
  if (duration_s < shortest_motion_s(cutoff_Hz) || recording.samples() < 50) {
    return fail(inconsistent("lasts " + short_number(duration_s) + " s with " + std::to_string(recording.samples()) +
                             " samples, too short for motion below " + rounded_number(cutoff_Hz) +
                             " Hz; record at least " + short_number(shortest_motion_s(cutoff_Hz)) + " s"));
  }
  if (cutoff_Hz * dt.value > 0.2) {
    return fail(inconsistent("cutoff_Hz", "a cutoff of " + rounded_number(cutoff_Hz) + " Hz is too high for " +
                                              short_number(1.0 / dt.value) +
                                              " samples a second; take at most a fifth of that with --cutoff-Hz"));
  }
  ArmMotion motion;
  motion.fast_stride_ =
      static_cast<std::size_t>(std::max(1.0, std::floor(1.0 / (fast_rate_factor * cutoff_Hz * dt.value))));
  motion.fast_cutoff_Hz_ = std::min(fast_factor * cutoff_Hz, 0.4 / dt.value);
  motion.cutoff_Hz_ = cutoff_Hz;
  motion.sample_time_ = dt;
  motion.fast_step_ = Seconds{dt.value * static_cast<double>(motion.fast_stride_)};

  std::vector<Filtered> all(recording.joints());
  std::vector<std::vector<double>> slopes;
  std::vector<std::vector<double>> measured;
  std::vector<bool> by_velocity;
  for (std::size_t j = 0; j < recording.joints(); ++j) {
    const auto smooth = zero_phase_low_pass(recording.position[j], cutoff_Hz, dt);
    if (!smooth) return fail(smooth.error());
    slopes.push_back(central_difference(*smooth, dt));
    if (moving == JointsThatMove::all && rms(slopes.back()) < slowest_rad_per_s) {
      return fail(inconsistent("position", "joint '" + joints[j] + "' (column '" + recording.position_names[j] +
                                               "') hardly moves: " + short_number(rms(slopes.back())) +
                                               " rad/s rms; record motion of all joints"));
    }
    bool use_velocity = false;
    if (!recording.velocity.empty()) {
      const auto filtered = zero_phase_low_pass(recording.velocity[j], cutoff_Hz, dt);
      if (!filtered) return fail(filtered.error());
      measured.push_back(*filtered);
      const double omega = 2.0 * std::numbers::pi * cutoff_Hz;
      // Of white noise below the cutoff: what remains of it in the acceleration.
      const double of_position = rms_apart(recording.position[j], *smooth) * omega * std::sqrt(3.0 / 5.0);
      use_velocity = 2.0 * rms_apart(recording.velocity[j], *filtered) < of_position;
    }
    by_velocity.push_back(use_velocity);
  }
  for (std::size_t j = 0; j < recording.joints(); ++j) {
    // The slope of one that stands is noise.
    const bool moves = rms(slopes[j]) >= slowest_rad_per_s;
    if (moves && !measured.empty() && disagreement(measured[j], slopes[j]) > most_disagreement) {
      return fail(wrong_velocity(recording, j, joints[j], measured[j], slopes));
    }
    // The fast cutoff is less than half of the rate, so the filter takes it.
    const auto fast = [&](const std::vector<double>& samples) {
      return *zero_phase_low_pass(samples, motion.fast_cutoff_Hz_, dt);
    };
    const std::vector<double> position = fast(recording.position[j]);
    std::vector<double> velocity = by_velocity[j] ? fast(recording.velocity[j]) : slope_of(position, dt);
    // Slopes are taken after the thinning: before it they would raise noise far above the cutoff, which thinning then
    // folds to below it.
    all[j].position = every(position, motion.fast_stride_);
    all[j].velocity =
        by_velocity[j] ? every(velocity, motion.fast_stride_) : slope_of(all[j].position, motion.fast_step_);
    all[j].acceleration = slope_of(all[j].velocity, motion.fast_step_);
    all[j].effort = every(fast(recording.effort[j]), motion.fast_stride_);
    motion.sampled_velocity_.push_back(std::move(velocity));
  }

  const double fast_rate = 1.0 / motion.fast_step_.value;
  const auto cut = static_cast<std::size_t>(std::ceil(fast_rate / cutoff_Hz));
  const double rate = std::clamp(rows_per_s, 2.0 * cutoff_Hz, fast_rate);
  motion.stride_ = static_cast<std::size_t>(std::max(1.0, std::floor(fast_rate / rate)));
  motion.first_ = cut;
  const std::size_t available = all.front().position.size();
  if (available <= 2 * cut + motion.stride_) return fail(inconsistent("is too short; record more"));
  motion.count_ = (available - 2 * cut - 1) / motion.stride_ + 1;
  const auto rows = static_cast<Eigen::Index>(motion.count_);
  const auto columns = static_cast<Eigen::Index>(recording.joints());
  for (Eigen::MatrixXd* matrix : {&motion.velocity, &motion.acceleration, &motion.effort}) {
    matrix->resize(rows, columns);
  }
  const auto fast_rows = static_cast<Eigen::Index>(available);
  for (Eigen::MatrixXd* matrix : {&motion.fast_position_, &motion.fast_velocity_, &motion.fast_acceleration_}) {
    matrix->resize(fast_rows, columns);
  }
  for (std::size_t j = 0; j < recording.joints(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    motion.velocity.col(column) = motion.low_passed(all[j].velocity);
    motion.acceleration.col(column) = motion.low_passed(all[j].acceleration);
    motion.effort.col(column) = motion.low_passed(all[j].effort);
    motion.fast_position_.col(column) = Eigen::Map<const Eigen::VectorXd>(all[j].position.data(), fast_rows);
    motion.fast_velocity_.col(column) = Eigen::Map<const Eigen::VectorXd>(all[j].velocity.data(), fast_rows);
    motion.fast_acceleration_.col(column) = Eigen::Map<const Eigen::VectorXd>(all[j].acceleration.data(), fast_rows);
  }
  for (std::size_t i = 0; i < motion.count_; ++i) {
    motion.time_s.push_back(static_cast<double>(motion.first_ + i * motion.stride_) * motion.fast_step_.value);
  }
  return motion;
}

Eigen::VectorXd ArmMotion::low_passed(std::span<const double> fast) const {
  // The cutoff is at most a fifth of the rate, so the filter takes it.
  const std::vector<double> smooth = *zero_phase_low_pass(fast, cutoff_Hz_, fast_step_);
  Eigen::VectorXd kept(static_cast<Eigen::Index>(count_));
  for (std::size_t i = 0; i < count_; ++i) kept[static_cast<Eigen::Index>(i)] = smooth[first_ + i * stride_];
  return kept;
}

Eigen::VectorXd ArmMotion::of_velocity(int joint, const std::function<double(double)>& law) const {
  const std::vector<double>& sampled = sampled_velocity_[static_cast<std::size_t>(joint)];
  std::vector<double> values(sampled.size());
  std::transform(sampled.begin(), sampled.end(), values.begin(), law);
  return low_passed(every(*zero_phase_low_pass(values, fast_cutoff_Hz_, sample_time_), fast_stride_));
}

Eigen::MatrixXd ArmMotion::of_motion(Eigen::Index columns, const Law& law) const {
  using Eigen::Index;
  const Index available = fast_position_.rows();
  const auto first_row = static_cast<Index>(first_);
  const auto stride = static_cast<Index>(stride_);
  const auto margin = static_cast<Index>(std::ceil(window_margin / (cutoff_Hz_ * fast_step_.value)));
  const Index in_window = std::max<Index>(1, window_rows / stride);
  Eigen::MatrixXd found(rows(), columns);
  Eigen::VectorXd values(columns);
  for (Index row = 0; row < rows(); row += in_window) {
    const Index count = std::min(in_window, rows() - row);
    const Index from = std::max<Index>(0, first_row + row * stride - margin);
    const Index end = std::min(available, first_row + (row + count - 1) * stride + 1 + margin);
    Eigen::MatrixXd window(end - from, columns);
    for (Index i = from; i < end; ++i) {
      law(fast_position_.row(i), fast_velocity_.row(i), fast_acceleration_.row(i), values);
      window.row(i - from) = values;
    }
    for (Index c = 0; c < columns; ++c) {
      const std::span<const double> column(window.col(c).data(), static_cast<std::size_t>(end - from));
      const std::vector<double> smooth = *zero_phase_low_pass(column, cutoff_Hz_, fast_step_);
      for (Index i = 0; i < count; ++i) {
        found(row + i, c) = smooth[static_cast<std::size_t>(first_row + (row + i) * stride - from)];
      }
    }
  }
  return found;
}

double ArmMotion::speed(int joint) const { return rms(sampled_velocity_[static_cast<std::size_t>(joint)]); }

}  // namespace tactus::arm_identification
