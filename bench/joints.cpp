// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/site_pair.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <bench/sections.hpp>
#include <benchmark/benchmark.h>

namespace tactus::bench {

namespace {

using station::Tick;

constexpr const char* section = "One tick of both supervised sites, by the number of joints";
constexpr double tick_s = 200e-6;
constexpr std::int64_t ticks_a_pass = 200;

/// Joints that swing and push, whatever they are told.
template <class Readings>
struct Swinging {
  Readings reading;
  std::int64_t number = 0;

  Readings read(const Tick&) noexcept {
    const double phase = 0.01 * static_cast<double>(++number);
    // A triangle: cheap beside a tick.
    const double swing = std::fabs(phase - 2.0 * std::floor(0.5 * phase) - 1.0);
    for_each_joint(
        [swing](station::DeviceReading& joint) noexcept {
          joint.position_m = 0.001 * swing;
          joint.force_N = 0.1 * swing;
        },
        reading);
    return reading;
  }
  void write(const Each<Readings, station::DeviceCommand>& command) noexcept { benchmark::DoNotOptimize(command); }
};

/// Sites that follow, ready to be stepped.
template <class Pair, class Readings>
void add_ticks(const std::string& name, const Readings& readings) {
  const auto params = same_for_each(readings, control::ControlParams());
  auto pair = Pair::make(params, {}, Seconds{tick_s}, same_for_each(readings, 0.0)).value();
  Swinging<Readings> master{readings}, slave{readings};
  std::int64_t number = 0;
  const auto run = [=](std::int64_t ticks, const control::SiteRequests& pressed) mutable {
    for (std::int64_t i = 0; i < ticks; ++i, ++number) {
      benchmark::DoNotOptimize(pair.step(master, slave, {.number = number, .deadline_ns = 200'000 * number}, pressed));
    }
    return pair.master().state();
  };
  auto ready = run;
  ready(10, {});
  ready(10, {.align = true});
  ready(10, {.arm = true});
  if (ready(500, {.dead_man = true}) != control::SiteState::active) std::abort();
  add_case(name, [ready]() mutable { ready(ticks_a_pass, {.dead_man = true}); });
}

std::string name_of_joints(std::size_t count) { return std::to_string(count) + " joints"; }

}  // namespace

void add_joints() {
  add_ticks<station::SupervisedPair>("one axis", station::DeviceReading());
  for (const std::size_t count : {1U, 2U, 4U, 8U}) {
    add_ticks<station::JointSupervisedPair>(name_of_joints(count), Joints<station::DeviceReading>(count));
  }
}

Findings joints(const Times& times) {
  const auto tick_us = [&times](const std::string& name) {
    return 1e6 * times.at(name) / static_cast<double>(ticks_a_pass);
  };
  using enum Finding::Goal;
  Findings findings{{section, "one axis", tick_us("one axis"), "us"}};
  for (const std::size_t count : {1U, 2U, 4U, 8U}) {
    findings.push_back({section, name_of_joints(count), tick_us(name_of_joints(count)), "us"});
  }
  findings.push_back({section, "8 joints / 8 times 1 joint",
                      tick_us(name_of_joints(8)) / (8.0 * tick_us(name_of_joints(1))), "", at_most, 1.1});
  findings.push_back({section, "8 joints / 8 times one axis", tick_us(name_of_joints(8)) / (8.0 * tick_us("one axis")),
                      "", at_most, 1.1});
  return findings;
}

}  // namespace tactus::bench
