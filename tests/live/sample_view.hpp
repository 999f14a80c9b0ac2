// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/interfaces/live/live_view.hpp>

#include <memory>
#include <string>
#include <string_view>

namespace tactus::live {

/// The experiment of these tests: the tapping experiment's loop at a gain at which it rings without cancellation, on
/// plant steps that are as long as they may be, for speed.
inline Settings sample_settings() {
  constexpr std::string_view text = R"(
task.kind = "tapping"
task.supervised = false
plant.longest_step_s = 2e-5
control.force_gain = 10.0
control.slave = { proportional_N_per_m = 100.0, derivative_N_s_per_m = 0.65, velocity = { cutoff_Hz = 300.0 } }
environment = { stiffness_N_per_m = 40000.0, damping_N_s_per_m = 3.0 }
master.encoder.resolution_m = 1e-5
slave = { encoder = { resolution_m = 1e-5 }, force_sensor = { bandwidth_Hz = 1000.0, noise_rms_N = 0.002 } }
)";
  return Settings::make(configuration::Document::parse(text, "sample.toml").value()).value();
}

/// Of one of its loops.
inline simulation::Teleoperator::Params sample_params(std::size_t loop) {
  return std::get<simulation::Teleoperator::Params>(sample_settings().of_loop(loop).value());
}

inline std::unique_ptr<LiveView> sample_view(bool allow_tuning = true) {
  return LiveView::make(sample_settings(), {.allow_tuning = allow_tuning, .experiment = "sample"}).value();
}

/// What a client publishes, without a client.
inline std::optional<Status> publish(LiveView& view, std::string_view topic, std::string_view json,
                                     ClientId client = 1) {
  return view.receive(client, topic, "json", json);
}

}  // namespace tactus::live
