// SPDX-License-Identifier: Apache-2.0
// A random sequence of calls of the C interface from four threads: `test_random_calls CALLS [SEED]`. Each thread has
// handles of its own, uses released ones and numbers of no handle, and all share one pair that runs, of arms behind
// function pointers. The program is for the sanitizers; it fails where a call returns a status that it may not.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <tactus.h>
#include <unistd.h>

namespace {

std::atomic<int> wrong{0};

void expect(bool holds, const char* what, tactus_status status) {
  if (holds) return;
  ++wrong;
  std::fprintf(stderr, "%s returned %d\n", what, status);
}

/// Two joints that a torque accelerates, 1 ms a call.
struct Arm {
  double position_rad[8] = {}, velocity_rad_per_s[8] = {};
};

int32_t make_arm(void*, const char*, const int64_t*, size_t, void** device, char*, size_t) {
  *device = new Arm;
  return 0;
}
int32_t open_arm(void*, char*, size_t) { return 0; }
int32_t exchange_arm(void* device, const tactus_motor_command* commands, tactus_motor_reading* readings, size_t motors,
                     char*, size_t) {
  auto& arm = *static_cast<Arm*>(device);
  for (size_t i = 0; i < motors; ++i) {
    constexpr double step_s = 0.001, inertia_kgm2 = 0.1, damping_Nms_per_rad = 0.2;
    const double torque = commands[i].enabled != 0 ? commands[i].torque_Nm : 0.0;
    arm.velocity_rad_per_s[i] += step_s * (torque - damping_Nms_per_rad * arm.velocity_rad_per_s[i]) / inertia_kgm2;
    arm.position_rad[i] += step_s * arm.velocity_rad_per_s[i];
    readings[i].position_rad = arm.position_rad[i];
    readings[i].velocity_rad_per_s = arm.velocity_rad_per_s[i];
    readings[i].enabled = commands[i].enabled;
  }
  return 0;
}
void close_arm(void*) {}
void release_arm(void* device) { delete static_cast<Arm*>(device); }

bool register_arm(const char* name) {
  tactus_joint_driver driver = TACTUS_JOINT_DRIVER_INIT;
  driver.name = name;
  driver.torque_limit_Nm = 5.0;
  driver.velocity_step_rad_per_s = 1e-4;
  driver.make = make_arm;
  driver.open = open_arm;
  driver.exchange = exchange_arm;
  driver.close = close_arm;
  driver.release = release_arm;
  return tactus_joint_driver_register(&driver, nullptr) == TACTUS_OK;
}

std::string rig_file() {
  std::string text;
  for (const char* side : {"leader", "follower"}) {
    const std::string section = std::string("arm.") + side;
    text += "[" + section + "]\nbus = \"random-arm\"\nwatchdog_s = 1.0\n";
    for (int motor = 1; motor <= 2; ++motor) {
      text += "[" + section + ".joint_" + std::to_string(motor) + "]\nmotor = " + std::to_string(motor) +
              "\nlower_rad = -1.5\nupper_rad = 1.5\nvelocity_limit_rad_per_s = 3.0\ntorque_limit_Nm = 2.5\n"
              "torque_rate_limit_Nm_per_s = 100.0\n";
    }
  }
  return text;
}

/// Longer than a computer under a sanitizer may keep a thread waiting.
const char* const relaxed[] = {"control.supervision.longest_stall_s=1.0", "control.supervision.watchdog.timeout_s=1.0",
                               "control.supervision.overload.missed_share=0.9"};

/// What one thread does with handles of its own and with the pair of all.
void call(std::uint64_t calls, std::uint64_t seed, tactus_teleoperator pair) {
  std::mt19937_64 random(seed);
  std::vector<tactus_cancellation> live;
  std::vector<std::uint64_t> gone{0, 1, ~std::uint64_t{0}};
  const char* const words[] = {"arm",  "press", "release", "clutch", "unclutch",
                               "stop", "clear", "start",   "keep",   "fly"};
  for (std::uint64_t i = 0; i < calls; ++i) {
    const bool lives = !live.empty() && random() % 3 != 0;
    const std::uint64_t handle = lives ? live[random() % live.size()] : gone[random() % gone.size()];
    const tactus_status found = lives ? TACTUS_OK : TACTUS_BAD_HANDLE;
    double number = 0.0;
    switch (random() % 16) {
      case 0: {
        tactus_cancellation_options options = TACTUS_CANCELLATION_OPTIONS_INIT;
        options.sample_time_s = random() % 4 == 0 ? -1.0 : 1e-3;
        tactus_cancellation made = 0;
        tactus_error error = 0;
        if (live.size() > 100) break;
        const tactus_status status = tactus_cancellation_make(&options, &made, &error);
        expect(status == (options.sample_time_s > 0.0 ? TACTUS_OK : TACTUS_OUT_OF_BOUNDS), "make", status);
        if (made != 0) live.push_back(made);
        if (error != 0) {
          tactus_error_view view = TACTUS_ERROR_VIEW_INIT;
          expect(tactus_error_read(error, &view) == TACTUS_OK && view.line[0] != 0, "error_read", view.status);
          expect(tactus_error_release(error) == TACTUS_OK, "error_release", 0);
        }
        break;
      }
      case 1: {
        if (!lives) {
          const tactus_status status = tactus_cancellation_release(handle);
          expect(status == (handle == 0 ? TACTUS_OK : TACTUS_BAD_HANDLE), "release", status);
          break;
        }
        expect(tactus_cancellation_release(handle) == TACTUS_OK, "release", 0);
        std::erase(live, handle);
        if (gone.size() < 100) gone.push_back(handle);
        break;
      }
      case 2: {
        tactus_teleoperator_view view = TACTUS_TELEOPERATOR_VIEW_INIT;
        // Text that a view points at belongs to one thread at a time: the others read none of the shared pair.
        const tactus_status status = tactus_teleoperator_read(seed % 4 == 0 ? pair : handle, &view);
        expect(status == (seed % 4 == 0 ? TACTUS_OK : TACTUS_BAD_HANDLE), "teleoperator_read", status);
        break;
      }
      case 3: {
        const tactus_status status = tactus_teleoperator_press(pair, words[random() % 10], nullptr);
        expect(status == TACTUS_OK || status == TACTUS_SYNTAX || status == TACTUS_FAILED, "press", status);
        break;
      }
      case 4: {
        tactus_joint_sample leader[2], follower[2];
        std::int64_t time_ns = 0;
        const std::size_t joints = random() % 4;
        const tactus_status status = tactus_teleoperator_newest(pair, joints, leader, follower, &time_ns);
        expect(status == (joints == 2 ? TACTUS_OK : TACTUS_OUT_OF_BOUNDS), "newest", status);
        break;
      }
      case 5:
        if (i % 512 == 0) expect(register_arm("other-arm"), "register", 0);
        break;
      case 6: {
        tactus_outcome_view view = TACTUS_OUTCOME_VIEW_INIT;
        expect(tactus_outcome_read(handle, &view) == TACTUS_BAD_HANDLE, "outcome_read", 0);
        break;
      }
      case 7: {
        tactus_teleoperator_report report = TACTUS_TELEOPERATOR_REPORT_INIT;
        const tactus_status status = tactus_teleoperator_report_read(pair, &report);
        expect(status == TACTUS_INCONSISTENT, "report", status);
        break;
      }
      case 8:
        expect(tactus_cancellation_reset(handle) == found, "reset", found);
        break;
      case 9:
        expect(tactus_cancellation_advance(handle, -0.1) == found, "advance", found);
        break;
      default:
        expect(tactus_cancellation_step(handle, 0.001, -0.1, &number) == found, "step", found);
    }
  }
  for (const tactus_cancellation handle : live) expect(tactus_cancellation_release(handle) == TACTUS_OK, "release", 0);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t calls = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 20'000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const std::string place = "/tmp/tactus-random-calls-" + std::to_string(getpid());
  const std::string rig = place + "-rig.toml";
  std::ofstream(rig) << rig_file();
  tactus_teleoperator pair = 0;
  tactus_error error = 0;
  tactus_teleoperator_options options = TACTUS_TELEOPERATOR_OPTIONS_INIT;
  options.experiment = TACTUS_EXPERIMENT;
  options.set = relaxed;
  options.set_count = std::size(relaxed);
  options.rig = rig.c_str();
  if (!register_arm("random-arm") || tactus_teleoperator_start(&options, &pair, &error) != TACTUS_OK) {
    tactus_error_view view = TACTUS_ERROR_VIEW_INIT;
    if (tactus_error_read(error, &view) == TACTUS_OK) std::fprintf(stderr, "%s\n", view.line);
    return 1;
  }
  std::vector<std::thread> threads;
  constexpr std::uint64_t count = 4;
  for (std::uint64_t i = 0; i < count; ++i) threads.emplace_back(call, calls / count, count * seed + i, pair);
  for (std::thread& thread : threads) thread.join();
  expect(tactus_teleoperator_stop(pair, nullptr) == TACTUS_OK, "stop", 0);
  tactus_teleoperator_report report = TACTUS_TELEOPERATOR_REPORT_INIT;
  expect(tactus_teleoperator_report_read(pair, &report) == TACTUS_OK && report.cycles > 0, "report", 0);
  expect(tactus_teleoperator_release(pair) == TACTUS_OK, "release", 0);
  expect(tactus_teleoperator_release(pair) == TACTUS_BAD_HANDLE, "release", 0);
  unlink(rig.c_str());
  std::printf("%llu calls, %d wrong\n", static_cast<unsigned long long>(calls), wrong.load());
  return wrong == 0 ? 0 : 1;
}
