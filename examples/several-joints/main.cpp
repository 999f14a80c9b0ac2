// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/joined_devices.hpp>
#include <tactus/runtime/servo/joint_streams.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/runtime/servo/site_log.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "../own-device/spring_carriage.hpp"

/// several-joints FOLDER: a leader and a follower of three joints each, at 1 kHz under supervision for three seconds,
/// with a log in FOLDER.
namespace {

using namespace tactus;

constexpr std::size_t joints = 3;
constexpr double rate_Hz = 1000.0;

/// Three motors that have nothing in common. A device whose joints share a bus derives from `station::JointDevice`.
Result<std::unique_ptr<station::JoinedDevices>> open_device(control::SiteRole role) {
  std::vector<std::unique_ptr<station::Device>> motors;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    motors.push_back(std::make_unique<SpringCarriage>(role == control::SiteRole::master, 1.0 / rate_Hz));
  }
  return station::JoinedDevices::make(std::move(motors));
}

/// What would be read of buttons: the person aligns, arms, holds the dead-man switch for two seconds and lets go.
control::SiteRequests pressed_at(double time_s) {
  return {.align = time_s > 0.1, .arm = time_s > 0.2, .dead_man = time_s > 0.3 && time_s < 2.3};
}

int fail(const Error& error) {
  std::fprintf(stderr, "several-joints: %s\n", describe(error).c_str());
  return exit_status(error);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "use: several-joints FOLDER\n");
    return 2;
  }
  // Each joint has parameters of its own; here the third is felt half as strongly.
  Joints<control::ControlParams> control(joints);
  for (auto& joint : control) joint.force_gain = 1.0;
  control[2].force_gain = 0.5;

  const auto leader = open_device(control::SiteRole::master), follower = open_device(control::SiteRole::slave);
  if (!leader) return fail(leader.error());
  if (!follower) return fail(follower.error());
  auto sites = station::JointLocalTeleoperator::make(control, {}, Seconds{1.0 / rate_Hz}, Joints<double>(joints, 0.0),
                                                     **leader, **follower);
  if (!sites) return fail(sites.error());
  runtime::JointStreams streams(joints);
  auto log = runtime::SiteLog::create(arguments[1], streams, {});
  if (!log) return fail(log.error());

  std::array<double, joints> felt_N{};
  const auto report = runtime::run_servo({.rate_Hz = rate_Hz}, [&](const station::Tick& tick) noexcept {
    const double time_s = static_cast<double>(tick.number) / rate_Hz;
    const control::SiteRequests pressed = pressed_at(time_s);
    // A follower that is armed holds its place: at the end all forces go.
    const bool over = time_s > 3.0;
    const auto done = over ? sites->step_to_rest(tick) : sites->step(tick, pressed);
    streams.push(tick, pressed, *sites, done);
    for (std::size_t joint = 0; joint < joints; ++joint) {
      felt_N[joint] = std::max(felt_N[joint], std::fabs(done.master.output.site[joint].motor_force_N));
    }
    return !over || !sites->at_rest();
  });
  if (!report) return fail(report.error());
  if (const auto error = log->close()) return fail(*error);
  std::printf("felt: %.2f, %.2f and %.2f N\n", felt_N[0], felt_N[1], felt_N[2]);
  return 0;
}
