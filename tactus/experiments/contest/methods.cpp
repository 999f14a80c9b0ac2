#include <tactus/experiments/contest/contest.hpp>

namespace tactus::experiments {

std::span<const ContestMethod> contest_methods() {
  constexpr std::string_view off = "control.cancellation=off";
  constexpr std::string_view on = "control.cancellation=on";
  static const std::vector<ContestMethod> methods{
      {"position-force", {off}},
      {"local damping", {off, "control.damping.damping_N_s_per_m=10"}},
      {"command low-pass", {off, "control.command_filter.kind=low-pass", "control.command_filter.frequency_Hz=30"}},
      {"command notch", {off, "control.command_filter.kind=notch"}},
      {"force low-pass", {off, "control.force_filter.kind=low-pass", "control.force_filter.frequency_Hz=30"}},
      {"force notch", {off, "control.force_filter.kind=notch"}},
      {"crossover to handle", {off, "control.crossover.frequency_Hz=30"}},
      {"hand compensation", {off, "control.hand_compensation_Hz=200"}},
      {"crossover, command low-pass",
       {off, "control.crossover.frequency_Hz=30", "control.command_filter.kind=low-pass",
        "control.command_filter.frequency_Hz=30"}},
      {"position-position", {off, "control.architecture=position-position"}},
      {"four-channel", {off, "control.architecture=four-channel"}},
      {"wave variables", {off, "control.architecture=wave-variables"}},
      {"time-domain passivity", {off, "control.architecture=time-domain-passivity"}},
      {"energy tank", {off, "control.architecture=energy-tank"}},
      {"projection", {off, "control.architecture=projection"}},
      {"shared compliant", {off, "control.architecture=shared-compliant"}},
      {"cancellation, second order", {on, "control.cancellation_model=second-order"}},
      {"cancellation, fourth order", {on, "control.cancellation_model=fourth-order"}},
      {"cancellation, sixth order linear", {on, "control.cancellation_model=sixth-order-linear"}},
      {"cancellation", {on}},
      {"cancellation, online grip", {on, "control.operator_estimate=online"}},
      {"cancellation, scheduled grip", {on, "control.operator_estimate=scheduled"}},
      {"cancellation, local damping", {on, "control.damping.damping_N_s_per_m=5"}},
      {"cancellation, command notch", {on, "control.command_filter.kind=notch"}},
      {"cancellation, hand compensation", {on, "control.hand_compensation_Hz=200"}},
      {"four-channel, cancellation", {on, "control.architecture=four-channel-cancellation"}},
  };
  return methods;
}

}  // namespace tactus::experiments
