// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/real_pair_transform.hpp>

#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Core>

namespace tactus::identification {
namespace {

using Complex = std::complex<double>;
using ComplexPair = RealPairTransform::ComplexPair;
using Lanes = Eigen::Array2d;

Eigen::Map<Lanes, Eigen::Aligned16> lanes(RealPairTransform::Pair& pair) {
  return Eigen::Map<Lanes, Eigen::Aligned16>(pair.data());
}
Eigen::Map<const Lanes, Eigen::Aligned16> lanes(const RealPairTransform::Pair& pair) {
  return Eigen::Map<const Lanes, Eigen::Aligned16>(pair.data());
}

void store(ComplexPair& to, const Lanes& re, const Lanes& im) {
  lanes(to.re) = re;
  lanes(to.im) = im;
}

void store_turned(ComplexPair& to, const Lanes& re, const Lanes& im, const Complex& by) {
  store(to, re * by.real() - im * by.imag(), re * by.imag() + im * by.real());
}

/// One pass over `count` sequences, interleaved, of `size` elements each: four transforms of a quarter of the size for
/// each one.
void radix_4(std::size_t size, std::size_t count, const Complex* unit_circle, const ComplexPair* from,
             ComplexPair* to) {
  const std::size_t quarter = size / 4;
  const std::size_t turn = 2 * count;  // the circle is divided into twice as many parts as there are elements
  for (std::size_t p = 0; p < quarter; ++p) {
    const Complex once = unit_circle[p * turn];
    const Complex twice = unit_circle[2 * p * turn];
    const Complex thrice = unit_circle[3 * p * turn];
    const ComplexPair* const first = from + count * p;
    ComplexPair* const out = to + 4 * count * p;
    for (std::size_t q = 0; q < count; ++q) {
      const ComplexPair& a = first[q];
      const ComplexPair& b = first[q + count * quarter];
      const ComplexPair& c = first[q + 2 * count * quarter];
      const ComplexPair& d = first[q + 3 * count * quarter];
      const Lanes sum_ac_re = lanes(a.re) + lanes(c.re), sum_ac_im = lanes(a.im) + lanes(c.im);
      const Lanes difference_ac_re = lanes(a.re) - lanes(c.re), difference_ac_im = lanes(a.im) - lanes(c.im);
      const Lanes sum_bd_re = lanes(b.re) + lanes(d.re), sum_bd_im = lanes(b.im) + lanes(d.im);
      const Lanes difference_bd_re = lanes(b.re) - lanes(d.re), difference_bd_im = lanes(b.im) - lanes(d.im);
      store(out[q], sum_ac_re + sum_bd_re, sum_ac_im + sum_bd_im);
      store_turned(out[q + count], difference_ac_re + difference_bd_im, difference_ac_im - difference_bd_re, once);
      store_turned(out[q + 2 * count], sum_ac_re - sum_bd_re, sum_ac_im - sum_bd_im, twice);
      store_turned(out[q + 3 * count], difference_ac_re - difference_bd_im, difference_ac_im + difference_bd_re,
                   thrice);
    }
  }
}

/// The last pass where the size is no power of four.
void radix_2(std::size_t count, const ComplexPair* from, ComplexPair* to) {
  for (std::size_t q = 0; q < count; ++q) {
    const ComplexPair &a = from[q], &b = from[q + count];
    store(to[q], lanes(a.re) + lanes(b.re), lanes(a.im) + lanes(b.im));
    store(to[q + count], lanes(a.re) - lanes(b.re), lanes(a.im) - lanes(b.im));
  }
}

}  // namespace

RealPairTransform::RealPairTransform(std::size_t length)
    : unit_circle_(length), samples_(length / 2), scratch_(length / 2), spectra_(length / 2 + 1) {
  const std::size_t quarter = length / 4;
  for (std::size_t k = 0; k < quarter; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(length);
    const Complex point{std::cos(angle), -std::sin(angle)};
    unit_circle_[k] = point;
    unit_circle_[k + quarter] = {point.imag(), -point.real()};
    unit_circle_[k + 2 * quarter] = -point;
    unit_circle_[k + 3 * quarter] = {-point.imag(), point.real()};
  }
}

std::span<const ComplexPair> RealPairTransform::spectra() {
  const std::size_t half = samples_.size();
  std::size_t size = half;
  std::size_t count = 1;
  for (; size >= 4; size /= 4, count *= 4) {
    radix_4(size, count, unit_circle_.data(), samples_.data(), scratch_.data());
    std::swap(samples_, scratch_);
  }
  if (size == 2) {
    radix_2(count, samples_.data(), scratch_.data());
    std::swap(samples_, scratch_);
  }
  // X(k) = ½ (Z(k) + Z*(N/2−k)) − ½ i exp(−2πik/N) (Z(k) − Z*(N/2−k)), Z the transform of even + i odd samples.
  for (std::size_t k = 0; k <= half; ++k) {
    const ComplexPair& here = samples_[k == half ? 0 : k];
    const ComplexPair& mirrored = samples_[k == 0 ? 0 : half - k];
    const Complex turn = k == half ? Complex{-1.0, 0.0} : unit_circle_[k];
    const Lanes even_re = lanes(here.re) + lanes(mirrored.re), even_im = lanes(here.im) - lanes(mirrored.im);
    const Lanes odd_re = lanes(here.im) + lanes(mirrored.im), odd_im = lanes(mirrored.re) - lanes(here.re);
    store(spectra_[k], 0.5 * (even_re + odd_re * turn.real() - odd_im * turn.imag()),
          0.5 * (even_im + odd_re * turn.imag() + odd_im * turn.real()));
  }
  return spectra_;
}

}  // namespace tactus::identification
