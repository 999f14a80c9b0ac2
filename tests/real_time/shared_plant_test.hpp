// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <string>

#include <unistd.h>

/// What the tests of a plant in another process have in common.
namespace tactus::real_time::shared_plant_test {

constexpr double observation_s = 0.15;
/// Two processes share two loaded cores: what is long for a machine that keeps time is not for this one.
constexpr Seconds patient{5.0};

/// A firm tap on a stiff wall with noise and tremor; at a rate that sanitizers keep up with.
inline experiments::TappingParams short_taps(double rate_Hz = 5000.0) {
  experiments::TappingParams params;
  params.task.supervised = false;
  params.task.taps = 2;
  params.task.observation_s = observation_s;
  params.task.slowest_m_per_s = 0.07;
  params.control.force_limit_N = 1.0;
  params.slave.force_sensor.noise_rms_N = 0.002;
  params.servo.rate_Hz = rate_Hz;
  return params;
}

inline std::string name_of(const char* test) { return std::string("test-") + test + "-" + std::to_string(getpid()); }

}  // namespace tactus::real_time::shared_plant_test
