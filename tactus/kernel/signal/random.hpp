// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace tactus::signal {

/// A stream of random numbers that is the same on every platform: xoshiro256** seeded through SplitMix64.
///
/// The engines of the standard library are specified, its distributions are not, so the distributions are here. Normal
/// numbers come from the ratio of uniforms with Leva's quadratic bounds: the result is one quotient of exactly
/// specified numbers, and the logarithm is only asked to accept or reject the 1 % of pairs near the edge, so a
/// last-digit difference between mathematics libraries cannot show in practice (Marsaglia's polar method would put it
/// into every number).
/// A value type: a copy continues as the original would. Real-time safe but for the worst case: the normal generator
/// draws 1.4 pairs on average, and without a bound.
/// Sources: D. Blackman and S. Vigna, Scrambled linear pseudorandom number generators, ACM TOMS 47(4), 2021; J. L.
/// Leva, A fast normal random number generator, ACM TOMS 18(4), 1992.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) noexcept : seed_(seed) {
    for (std::uint64_t& word : state_) {
      word = mix(seed += golden_gamma);
    }
  }

  /// An independent stream, the same however many numbers this one has given out: the noise of one sensor does not
  /// depend on whether another is there. Different indices, and forks of forks, give unrelated streams.
  [[nodiscard]] constexpr Random fork(std::uint64_t stream_index) const noexcept {
    return Random(mix(seed_ + golden_gamma) ^ mix(~stream_index));
  }

  /// 64 random bits.
  constexpr std::uint64_t bits() noexcept {
    const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

  /// Uniform in [0, 1), a multiple of 2⁻⁵³.
  constexpr double uniform() noexcept { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Uniform in [lower, upper), for lower < upper.
  double uniform(double lower, double upper) noexcept {
    const double value = lower + (upper - lower) * uniform();
    return std::min(value, std::nextafter(upper, lower));  // the sum may round up to the end that is left out
  }

  /// Normal with mean 0 and standard deviation 1.
  double normal() noexcept {
    for (;;) {
      const double u = 1.0 - uniform();
      const double v = 1.7156 * (uniform() - 0.5);  // a little more than 2 √(2/e), the height of the region
      const double x = u - 0.449871;
      const double y = std::fabs(v) + 0.386595;
      const double bound = x * x + y * (0.19600 * y - 0.25472 * x);
      if (bound < 0.27597) return v / u;
      if (bound <= 0.27846 && v * v <= -4.0 * u * u * std::log(u)) return v / u;
    }
  }

 private:
  static constexpr std::uint64_t golden_gamma = 0x9e3779b97f4a7c15;

  /// The output function of SplitMix64: a bijection of 64 bits in which every input bit reaches every output bit.
  static constexpr std::uint64_t mix(std::uint64_t z) noexcept {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  std::uint64_t seed_;
  std::array<std::uint64_t, 4> state_{};
};

}  // namespace tactus::signal
