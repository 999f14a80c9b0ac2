// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/stages/stage.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <array>
#include <optional>

namespace tactus::control {

/// How a signal of the loop is shaped.
enum class Shaping { none, low_pass, notch };
constexpr auto enumerators(Shaping) {
  return std::array{Enumerator{Shaping::none, "none"}, Enumerator{Shaping::low_pass, "low-pass"},
                    Enumerator{Shaping::notch, "notch"}};
}

/// A filter in the loop, there only where it is asked for: the position-command filter F_p and the force filter F_f of
/// Kuchenbecker and Niemeyer, "Induced Master Motion in Force-Reflecting Teleoperation", eq. 5 and 6.
///
///     x_m = x_int + G_ind(G_se(F_p x_m))      x_m = x_int + G_ind(F_f G_se(x_m))
///
/// Both are in the same loop and lower its gain alike; they differ in who pays. The first lags the slave, by
/// √2 / (2π f) for a low-pass and by width / (2π f²) for a notch at slow motion; the second keeps the removed band from
/// the hand. Second order, so that the band next to the frequency keeps most of its phase.
///
/// The first sample after `make` or `reset` is taken for what the signal has always been, so a position far from zero
/// starts without a transient. `none` gives back every sample bit for bit. Frequency and width below half the sample
/// rate, where there is a filter.
class ShapingFilter {
 public:
  struct Params {
    Shaping kind = Shaping::none;
    double frequency_Hz = 75.0;
    double notch_width_Hz = 75.0;
    static constexpr auto fields() {
      return List{
          field("kind", &Params::kind, "Frequencies that it removes: none, low-pass (all above) or notch (a band)."),
          field("frequency_Hz", &Params::frequency_Hz, units::hertz, positive,
                "The -3 dB frequency of the low-pass, or the centre of the notch; below half the servo rate."),
          field("notch_width_Hz", &Params::notch_width_Hz, units::hertz, positive,
                "Distance between the two -3 dB frequencies of the notch; below half the servo rate.")};
    }
  };
  using Input = double;
  using Output = double;

  static constexpr int linear_states = 2;
  static constexpr std::optional<Unfit> not_on_lanes(const Params& params) {
    if (params.kind == Shaping::none) return {};
    return Unfit{"kind", "write none"};
  }

  static Result<ShapingFilter> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    ShapingFilter shaping;
    if (params.kind == Shaping::none) return shaping;
    const auto kind = params.kind == Shaping::notch ? signal::FilterKind::notch : signal::FilterKind::low_pass;
    const auto filter = signal::SecondOrderFilter::make(
        {.kind = kind, .frequency_Hz = params.frequency_Hz, .notch_width_Hz = params.notch_width_Hz}, dt);
    if (!filter) return filter.error();
    shaping.filter_ = *filter;
    return shaping;
  }

  /// The shaped sample. Real-time safe.
  double step(double input) noexcept {
    if (!filter_) return input;
    if (!started_) filter_->settle(input);
    started_ = true;
    return filter_->step(input);
  }

  /// As made: the next sample starts it.
  void reset() noexcept {
    if (filter_) filter_->reset();
    started_ = false;
  }

 private:
  ShapingFilter() = default;
  std::optional<signal::SecondOrderFilter> filter_;
  bool started_ = false;
};

}  // namespace tactus::control
