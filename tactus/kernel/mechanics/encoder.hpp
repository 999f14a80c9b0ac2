// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/scalar.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cmath>

namespace tactus::mechanics {

/// The nearest multiple of `resolution`, halves up; the value itself for a resolution of 0.
template <class Scalar>
Scalar quantised(const Scalar& value, const Scalar& resolution) noexcept {
  using std::floor;
  return select(resolution > 0.0, floor(value / resolution + 0.5) * resolution, value);
}

/// Quantised position, as an encoder reports it at the servo tick: the nearest multiple of the resolution, halves up.
///
/// Nearest and not next lower, although a counter of edges does the latter: the two differ by a constant half step,
/// which the choice of zero hides in any real machine. With the nearest, a position that rests at zero stays half a
/// step away from the next count, and the error has no mean. A resolution of zero is an ideal sensor. No state.
class Encoder {
 public:
  struct Params {
    double resolution_m = 0.0;
    static constexpr auto fields() {
      return List{field("resolution_m", &Params::resolution_m, units::metre, non_negative,
                        "Distance between two counts, at the operator's hand; 0 is an ideal sensor.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<Encoder> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    return Encoder(params.resolution_m);
  }

  /// Position in m as reported, from the true position in m. Real-time safe.
  double step(double position_m) noexcept { return quantised(position_m, resolution_m_); }

  void reset() noexcept {}

 private:
  explicit Encoder(double resolution_m) : resolution_m_(resolution_m) {}
  double resolution_m_;
};

}  // namespace tactus::mechanics
