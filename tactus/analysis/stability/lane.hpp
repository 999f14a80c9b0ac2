// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace tactus::stability {

/// `count` numbers side by side that go through the same arithmetic, in one vector register. What a template on the
/// scalar needs: operators, comparisons that give a mask, and, found by their arguments, `select`, `any`, `min`, `max`,
/// `fabs`, `floor`, `copysign` and `expm1`.
///
/// Each lane does what a `double` (or `float`) would do, bit for bit: the compiler must neither contract nor reorder
/// (-ffp-contract=off, no -ffast-math), `min` and `max` pick as std::min and std::max do, and `expm1` calls the C
/// library once a lane. GCC's vector types: the width is a template parameter, and code for any width compiles for any
/// target, if slowly.
template <class Real_, std::size_t count_>
struct Lane {
  using Real = Real_;
  static constexpr std::size_t count = count_;
  using Whole = std::conditional_t<sizeof(Real) == 8, std::int64_t, std::int32_t>;
  using Vector [[gnu::vector_size(sizeof(Real) * count)]] = Real;
  using Bits [[gnu::vector_size(sizeof(Real) * count)]] = Whole;

  /// All ones where true.
  struct Mask {
    Bits bits;
    friend Mask operator==(Mask a, Mask b) noexcept { return {~(a.bits ^ b.bits)}; }
    friend Mask operator!=(Mask a, Mask b) noexcept { return {a.bits ^ b.bits}; }
    friend Mask operator&(Mask a, Mask b) noexcept { return {a.bits & b.bits}; }
    friend Mask operator|(Mask a, Mask b) noexcept { return {a.bits | b.bits}; }
    friend bool any(Mask mask) noexcept {
#if defined(__AVX512F__)
      if constexpr (sizeof(Bits) == 64) {
        const auto bits = reinterpret_cast<__m512i>(mask.bits);
        return _mm512_test_epi64_mask(bits, bits) != 0;
      }
#endif
#if defined(__AVX__)
      if constexpr (sizeof(Bits) == 32) return _mm256_movemask_pd(reinterpret_cast<__m256d>(mask.bits)) != 0;
#endif
#if defined(__SSE2__)
      if constexpr (sizeof(Bits) == 16) return _mm_movemask_pd(reinterpret_cast<__m128d>(mask.bits)) != 0;
#endif
      Whole sum = 0;
      for (std::size_t i = 0; i < count; ++i) sum |= mask.bits[i];
      return sum != 0;
    }
  };

  Vector v;

  Lane() noexcept = default;
  // Implicit on purpose: a number stands for itself in every lane, as in `0.5 * x`.
  Lane(double value) noexcept : v(Vector{} + static_cast<Real>(value)) {}
  explicit Lane(Vector vector) noexcept : v(vector) {}

  friend Lane operator+(Lane a, Lane b) noexcept { return Lane(Vector(a.v + b.v)); }
  friend Lane operator-(Lane a, Lane b) noexcept { return Lane(Vector(a.v - b.v)); }
  friend Lane operator*(Lane a, Lane b) noexcept { return Lane(Vector(a.v * b.v)); }
  friend Lane operator/(Lane a, Lane b) noexcept { return Lane(Vector(a.v / b.v)); }
  friend Lane operator-(Lane a) noexcept { return Lane(Vector(-a.v)); }
  Lane& operator+=(Lane b) noexcept { return *this = *this + b; }

  friend Mask operator<(Lane a, Lane b) noexcept { return {Bits(a.v < b.v)}; }
  friend Mask operator>(Lane a, Lane b) noexcept { return {Bits(a.v > b.v)}; }
  friend Mask operator>=(Lane a, Lane b) noexcept { return {Bits(a.v >= b.v)}; }
  friend Lane select(Mask mask, Lane yes, Lane no) noexcept { return Lane(Vector(mask.bits ? yes.v : no.v)); }
  friend Lane min(Lane a, Lane b) noexcept { return Lane(Vector(b.v < a.v ? b.v : a.v)); }
  friend Lane max(Lane a, Lane b) noexcept { return Lane(Vector(b.v > a.v ? b.v : a.v)); }
  friend Lane fabs(Lane a) noexcept {
    return Lane(reinterpret_cast<Vector>(reinterpret_cast<Bits>(a.v) & ~sign_bits()));
  }
  friend Lane copysign(Lane size, Lane sign) noexcept {
    return Lane(reinterpret_cast<Vector>((reinterpret_cast<Bits>(size.v) & ~sign_bits()) |
                                         (reinterpret_cast<Bits>(sign.v) & sign_bits())));
  }
  [[nodiscard]] Real get(std::size_t lane) const noexcept { return v[lane]; }
  void set(std::size_t lane, double value) noexcept { v[lane] = static_cast<Real>(value); }

  /// For magnitudes below 2⁵¹ (2²² in float): rounds by adding a number so large that no fraction fits alongside it.
  friend Lane floor(Lane a) noexcept {
    constexpr Real large = sizeof(Real) == 8 ? Real(6755399441055744.0) : Real(12582912.0f);
    const Lane nearest = Lane(Vector((a.v + large) - large));
    return select(nearest > a, nearest - Lane(1.0), nearest);
  }
  friend Lane expm1(Lane a) noexcept {
    Lane result;
    for (std::size_t i = 0; i < count; ++i) result.v[i] = std::expm1(Real(a.v[i]));
    return result;
  }

 private:
  static Bits sign_bits() noexcept { return Bits{} + sign_bit; }
  static constexpr Whole sign_bit = std::numeric_limits<Whole>::min();
};

/// Two lane types alongside each other, as one of twice as many numbers. A loop is one long chain of operations, each
/// of which waits for the last; the two halves do not wait for each other, so the processor works on both.
template <class Half>
struct LanePair {
  using Real = typename Half::Real;
  static constexpr std::size_t count = 2 * Half::count;

  struct Mask {
    typename Half::Mask low, high;
    friend Mask operator==(Mask a, Mask b) noexcept { return {a.low == b.low, a.high == b.high}; }
    friend Mask operator!=(Mask a, Mask b) noexcept { return {a.low != b.low, a.high != b.high}; }
    friend Mask operator&(Mask a, Mask b) noexcept { return {a.low & b.low, a.high & b.high}; }
    friend Mask operator|(Mask a, Mask b) noexcept { return {a.low | b.low, a.high | b.high}; }
    friend bool any(Mask mask) noexcept { return any(mask.low | mask.high); }
  };

  Half low, high;

  LanePair() noexcept = default;
  // Implicit on purpose, as that of a lane.
  LanePair(double value) noexcept : low(value), high(value) {}
  LanePair(Half first, Half second) noexcept : low(first), high(second) {}

  friend LanePair operator+(LanePair a, LanePair b) noexcept { return {a.low + b.low, a.high + b.high}; }
  friend LanePair operator-(LanePair a, LanePair b) noexcept { return {a.low - b.low, a.high - b.high}; }
  friend LanePair operator*(LanePair a, LanePair b) noexcept { return {a.low * b.low, a.high * b.high}; }
  friend LanePair operator/(LanePair a, LanePair b) noexcept { return {a.low / b.low, a.high / b.high}; }
  friend LanePair operator-(LanePair a) noexcept { return {-a.low, -a.high}; }
  LanePair& operator+=(LanePair b) noexcept { return *this = *this + b; }

  friend Mask operator<(LanePair a, LanePair b) noexcept { return {a.low < b.low, a.high < b.high}; }
  friend Mask operator>(LanePair a, LanePair b) noexcept { return {a.low > b.low, a.high > b.high}; }
  friend Mask operator>=(LanePair a, LanePair b) noexcept { return {a.low >= b.low, a.high >= b.high}; }
  friend LanePair select(Mask mask, LanePair yes, LanePair no) noexcept {
    return {select(mask.low, yes.low, no.low), select(mask.high, yes.high, no.high)};
  }
  friend LanePair min(LanePair a, LanePair b) noexcept { return {min(a.low, b.low), min(a.high, b.high)}; }
  friend LanePair max(LanePair a, LanePair b) noexcept { return {max(a.low, b.low), max(a.high, b.high)}; }
  friend LanePair fabs(LanePair a) noexcept { return {fabs(a.low), fabs(a.high)}; }
  friend LanePair copysign(LanePair size, LanePair sign) noexcept {
    return {copysign(size.low, sign.low), copysign(size.high, sign.high)};
  }
  [[nodiscard]] Real get(std::size_t lane) const noexcept {
    return lane < Half::count ? low.get(lane) : high.get(lane - Half::count);
  }
  void set(std::size_t lane, double value) noexcept {
    lane < Half::count ? low.set(lane, value) : high.set(lane - Half::count, value);
  }
  friend LanePair floor(LanePair a) noexcept { return {floor(a.low), floor(a.high)}; }
  friend LanePair expm1(LanePair a) noexcept { return {expm1(a.low), expm1(a.high)}; }
};

}  // namespace tactus::stability
