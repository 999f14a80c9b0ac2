// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>

namespace tactus::bench {

/// A number that counts what is done with numbers, so that the operations of a loop are known and not guessed.
class Counted {
 public:
  using Real = double;
  static constexpr std::size_t count = 1;
  /// Additions, multiplications, minima and maxima; and divisions.
  static inline double operations = 0.0, divisions = 0.0;

  Counted() = default;
  // Implicit on purpose: a number stands for itself.
  Counted(double value) : value_(value) {}
  [[nodiscard]] double get(std::size_t) const { return value_; }
  void set(std::size_t, double value) { value_ = value; }

  friend Counted operator+(Counted a, Counted b) { return counted(a.value_ + b.value_); }
  friend Counted operator-(Counted a, Counted b) { return counted(a.value_ - b.value_); }
  friend Counted operator*(Counted a, Counted b) { return counted(a.value_ * b.value_); }
  friend Counted operator/(Counted a, Counted b) {
    ++divisions;
    return a.value_ / b.value_;
  }
  friend Counted operator-(Counted a) { return -a.value_; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  friend bool operator<(Counted a, Counted b) { return a.value_ < b.value_; }
  friend bool operator>(Counted a, Counted b) { return a.value_ > b.value_; }
  friend bool operator>=(Counted a, Counted b) { return a.value_ >= b.value_; }
  friend Counted min(Counted a, Counted b) { return counted(b.value_ < a.value_ ? b.value_ : a.value_); }
  friend Counted max(Counted a, Counted b) { return counted(b.value_ > a.value_ ? b.value_ : a.value_); }
  friend Counted fabs(Counted a) { return std::fabs(a.value_); }
  friend Counted floor(Counted a) { return counted(std::floor(a.value_)); }
  friend Counted copysign(Counted size, Counted sign) { return std::copysign(size.value_, sign.value_); }
  friend Counted expm1(Counted a) { return counted(std::expm1(a.value_)); }

 private:
  static Counted counted(double value) {
    ++operations;
    return value;
  }
  double value_ = 0.0;
};

}  // namespace tactus::bench
