// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/real_time/plant_server.hpp>
#include <tactus/simulation/real_time/real_time_tap.hpp>
#include <tactus/simulation/real_time/shared_plant.hpp>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <thread>

#include "tests/real_time/tick_guard.hpp"
#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::real_time {
namespace {

constexpr int first_armed_step = 200;
constexpr int faulty_step = 700;
constexpr int last_armed_step = 1500;  ///< well after the touch

constexpr double longest_s = 10.0;  ///< without privileges many ticks are missed

constexpr std::size_t page_bytes = 4096;
char* missing_page = nullptr;
void* spare = nullptr;
std::mutex mutex;

/// What a fault works on, made on the servo thread before it is armed. Memory is locked by then, so that a page must be
/// given back to be missing.
void prepare() noexcept {
  void* page = mmap(nullptr, page_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  munlock(page, page_bytes);
  madvise(page, page_bytes, MADV_DONTNEED);
  missing_page = static_cast<char*>(page);
  spare = std::malloc(64);
}

/// A plant that another thread owns, as another process would, and this one drives.
class OwnedPlant {
 public:
  explicit OwnedPlant(const experiments::TappingParams& params)
      : server_(*PlantServer::make(name(), params, patient)), servo_(*Servo::start({.priority = 10}, Step{*server_})) {
    driven_ = *SharedPlant::attach(name(), patient);
  }
  /// At the start of the first tap.
  SharedPlant& begin() {
    std::atomic<bool> begun{false};
    std::thread maker([&] {
      for (; !begun; std::this_thread::sleep_for(std::chrono::milliseconds(1))) server_->serve();
    });
    const Check refused = driven_->begin(0);
    begun = true;
    maker.join();
    if (refused) _exit(5);
    return *driven_;
  }

 private:
  struct Step {
    PlantServer& server;
    bool operator()(const station::Tick& tick) const noexcept {
      server.step(tick);
      return true;
    }
  };
  using Servo = runtime::ServoThread<Step>;
  static constexpr Seconds patient{5.0};
  static std::string name() { return "test-armed-" + std::to_string(getpid()); }

  std::unique_ptr<PlantServer> server_;
  std::unique_ptr<Servo> servo_;
  std::unique_ptr<SharedPlant> driven_;
};

enum class Devices { own, of_another };

/// The whole armed loop in a process of its own: servo thread, both sites, simulated devices, log. `fault` runs in one
/// of its ticks.
Deeds watch(void (*fault)() noexcept, Devices devices = Devices::own) {
  void* shared = mmap(nullptr, sizeof(Deeds), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  auto* result = new (shared) Deeds;
  result->system_calls = -1;  // until the child has reported
  const auto file = scratch_path().concat(".mcap");
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    experiments::TappingParams params;
    params.task.taps = 1;
    params.control.force_gain = 10.0;
    const auto ensemble = experiments::TappingEnsemble::make(params);
    auto recorder = telemetry::Recorder::create(file);
    if (!ensemble || !recorder) _exit(2);
    const runtime::RealTimeStreams streams{
        .teleoperator =
            &recorder->add<simulation::Teleoperator::Record>("/teleoperator", "tactus_msgs/msg/Teleoperator"),
        .servo = &recorder->add<runtime::ServoRecord>("/servo", "tactus_msgs/msg/ServoRecord"),
        .origin_ns = runtime::monotonic_ns()};
    recorder->start();
    std::optional<OwnedPlant> plant;
    if (devices == Devices::of_another) plant.emplace(params);
    const auto tap = plant ? RealTimeTap::make(ensemble->tap(0), longest_s, plant->begin(), streams)
                           : RealTimeTap::make(ensemble->tap(0), longest_s, streams);
    if (!tap) _exit(3);
    RealTimeTap& running = **tap;
    int steps = 0;
    const auto report =
        runtime::run_servo({.rate_Hz = 5000.0, .priority = 10}, [&](const station::Tick& tick) noexcept {
          if (steps == 0) prepare();
          if (steps == first_armed_step) arm(*result);
          if (steps == faulty_step && fault != nullptr) fault();
          if (steps == last_armed_step) {
            disarm();
            _exit(0);
          }
          ++steps;
          return running.step(tick);
        });
    _exit(4);  // the tap was over too early
  }
  int status = 0;
  waitpid(child, &status, 0);
  // The child ends in the middle of a tick and leaves its plant behind.
  shm_unlink(("/tactus-plant-test-armed-" + std::to_string(child)).c_str());
  const Deeds deeds = *result;
  munmap(shared, sizeof(Deeds));
  std::filesystem::remove(file);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "the child ended with " << status;
  EXPECT_GE(deeds.system_calls, 0) << "the child did not report";
  return deeds;
}

void expect_no_deed(const Deeds& deeds) {
  EXPECT_EQ(deeds.allocations, 0);
  EXPECT_EQ(deeds.locks, 0);
  EXPECT_EQ(deeds.minor_faults, 0);
  EXPECT_EQ(deeds.major_faults, 0);
  EXPECT_EQ(deeds.system_calls, 0) << "the first was number " << deeds.first_system_call;
}

TEST(ArmedTick, DoesNotAllocateLockFaultOrCallTheSystem) { expect_no_deed(watch(nullptr)); }

TEST(ArmedTick, DoesNeitherWhereAnotherProcessOwnsTheDevices) { expect_no_deed(watch(nullptr, Devices::of_another)); }

struct Fault {
  const char* name;
  void (*make)() noexcept;
  std::int64_t Deeds::*counted;
};

const Fault faults[] = {
    {"New", []() noexcept { ::operator delete(::operator new(100)); }, &Deeds::allocations},
    {"Malloc", []() noexcept { spare = std::malloc(100); }, &Deeds::allocations},
    {"Free", []() noexcept { std::free(spare); }, &Deeds::allocations},
    {"UncontendedLock", []() noexcept { const std::lock_guard lock(mutex); }, &Deeds::locks},
    {"MissingPage", []() noexcept { *static_cast<volatile char*>(missing_page) = 1; }, &Deeds::minor_faults},
    {"SystemCall", []() noexcept { (void)getppid(); }, &Deeds::system_calls},
    {"Output", []() noexcept { (void)!write(STDERR_FILENO, "", 0); }, &Deeds::system_calls},
    {"Sleep", []() noexcept { std::this_thread::sleep_for(std::chrono::microseconds(1)); }, &Deeds::system_calls},
    {"Yield", []() noexcept { std::this_thread::yield(); }, &Deeds::system_calls},
};

class FaultyTick : public ::testing::TestWithParam<Fault> {};

TEST_P(FaultyTick, IsFound) { EXPECT_GT(watch(GetParam().make).*GetParam().counted, 0); }

INSTANTIATE_TEST_SUITE_P(Every, FaultyTick, ::testing::ValuesIn(faults),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace tactus::real_time
