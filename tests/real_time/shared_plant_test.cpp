// SPDX-License-Identifier: Apache-2.0
#include "tests/real_time/shared_plant_test.hpp"

#include <tactus/simulation/real_time/plant_server.hpp>
#include <tactus/simulation/real_time/real_time_tap.hpp>
#include <tactus/simulation/real_time/shared_plant.hpp>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::real_time {
namespace shared_plant_test {

using namespace std::chrono_literals;
using experiments::TappingEnsemble;
using experiments::TappingParams;
using Record = simulation::Teleoperator::Record;

station::Tick tick(std::int64_t number) {
  const std::int64_t due_ns = 200'000 * number;
  return {.number = number, .deadline_ns = due_ns, .began_ns = due_ns};
}

/// Both sides in this process, on a clock of the test's.
struct LockStep {
  std::unique_ptr<PlantServer> server;
  std::unique_ptr<SharedPlant> plant;
  std::int64_t number = 1000;

  LockStep(const std::string& name, const TappingParams& params, Seconds silence) {
    auto made = PlantServer::make(name, params, silence);
    EXPECT_TRUE(made) << describe(made.error());
    server = *std::move(made);
    server->step(tick(number));
    auto attached = SharedPlant::attach(name, silence);
    EXPECT_TRUE(attached) << describe(attached.error());
    plant = *std::move(attached);
    EXPECT_FALSE(plant->check(params));
  }
  /// Asks for a tap, while the plant goes on standing.
  Check begin(std::size_t tap) {
    std::atomic<bool> begun{false};
    std::thread owner([&] {
      while (!begun.load()) {
        server->serve();
        server->step(tick(++number));
        std::this_thread::sleep_for(1ms);
      }
    });
    Check refused = plant->begin(tap);
    begun = true;
    owner.join();
    return refused;
  }
};

std::vector<std::uint64_t> bits(const Record& record) {
  std::vector<std::uint64_t> all;
  for_each_signal<Record>([&](const auto& signal) {
    const auto member = record.*signal.member;
    if constexpr (sizeof(member) == sizeof(std::uint64_t)) {
      all.push_back(std::bit_cast<std::uint64_t>(member));
    } else {
      all.push_back(member ? 1 : 0);
    }
  });
  return all;
}

TEST(SharedPlant, InLockStepItIsBitForBitTheTapInVirtualTime) {
  const TappingParams params = short_taps();
  const auto ensemble = TappingEnsemble::make(params);
  ASSERT_TRUE(ensemble);
  LockStep both(name_of("lock"), params, patient);
  for (const std::size_t tap : {1U, 0U, 1U}) {
    std::vector<Record> virtual_time;
    (void)ensemble->run(tap, &virtual_time);
    ASSERT_FALSE(both.begin(tap));
    auto running = RealTimeTap::make(ensemble->tap(tap), observation_s, *both.plant);
    ASSERT_TRUE(running);
    while ((*running)->step(tick(both.number))) both.server->step(tick(++both.number));
    both.plant->end();
    const auto& trace = (*running)->trace();
    ASSERT_EQ(trace.size(), virtual_time.size());
    for (std::size_t i = 0; i < trace.size(); ++i) ASSERT_EQ(bits(trace[i]), bits(virtual_time[i])) << "tick " << i;
    EXPECT_TRUE((*running)->result().touched);
  }
  EXPECT_EQ(both.server->status().taps, 3);
  EXPECT_EQ(both.server->status().released, 0);
}

TEST(SharedPlant, WithoutItsControllerThePlantLetsGoAndStandsReadyForTheNext) {
  const TappingParams params = short_taps();
  const auto ensemble = TappingEnsemble::make(params);
  LockStep both(name_of("silent"), params, Seconds{0.01});
  ASSERT_FALSE(both.begin(0));
  auto running = RealTimeTap::make(ensemble->tap(0), observation_s, *both.plant);
  ASSERT_TRUE(running);
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE((*running)->step(tick(both.number)));
    both.server->step(tick(++both.number));
  }
  for (int i = 1; i < 50; ++i) both.server->step(tick(++both.number));
  EXPECT_EQ(both.server->status().released, 0) << "within its bound";
  both.server->step(tick(++both.number));
  EXPECT_EQ(both.server->status().released, 1);
  // The controller hears of it, lets go too, and the tap is over.
  int steps = 0;
  while ((*running)->step(tick(both.number)) && steps < 100) {
    both.server->step(tick(++both.number));
    ++steps;
  }
  EXPECT_LT(steps, 100);
  ASSERT_TRUE(both.plant->lost());
  EXPECT_NE(both.plant->why_lost().message.find("too late"), std::string::npos) << both.plant->why_lost().message;
  ASSERT_FALSE(both.begin(1));
  (void)both.plant->master().read(tick(both.number));
  EXPECT_FALSE(both.plant->lost());
  EXPECT_EQ(both.server->status().released, 1);
}

TEST(SharedPlant, MemoryThatIsCutShortInMidRunEndsItOnBothSidesInWords) {
  const TappingParams params = short_taps();
  const auto ensemble = TappingEnsemble::make(params);
  const std::string name = name_of("cut");
  LockStep both(name, params, patient);
  ASSERT_FALSE(both.begin(0));
  auto running = RealTimeTap::make(ensemble->tap(0), observation_s, *both.plant);
  ASSERT_TRUE(running);
  int steps = 0;
  while ((*running)->step(tick(both.number)) && steps < 1000) {
    if (steps == 500) {
      const pid_t child = fork();
      if (child == 0) _exit(truncate(("/dev/shm/tactus-plant-" + name).c_str(), 0) == 0 ? 0 : 1);
      int status = -1;
      waitpid(child, &status, 0);
      ASSERT_EQ(status, 0);
    }
    both.server->step(tick(++both.number));
    both.server->serve();
    ++steps;
  }
  EXPECT_GT(steps, 500);
  EXPECT_LT(steps, 600) << "the sites let go";
  EXPECT_TRUE(both.plant->lost());
  EXPECT_NE(both.plant->why_lost().message.find("shortened its shared memory"), std::string::npos)
      << both.plant->why_lost().message;
  EXPECT_TRUE(both.server->status().cut);
  EXPECT_TRUE(both.plant->begin(1)) << "nobody can drive it any more";
}

TEST(SharedPlant, ACommandFarBeyondTheDeviceNeverReachesItAndTheControllerHearsWhy) {
  TappingParams params = short_taps();
  params.control.gate.force_limit_N = 1.5;
  params.control.gate.rate_limit_N_per_s = 1000.0;
  LockStep both(name_of("wrong"), params, Seconds{0.01});
  EXPECT_EQ(both.plant->master().limits().force_N, 1.5);
  ASSERT_FALSE(both.begin(0));
  std::int64_t own = 0;
  for (; own < 200 && !both.plant->lost(); ++own) {
    station::Tick now = tick(both.number);
    now.number = own;
    (void)both.plant->master().read(now);
    (void)both.plant->slave().read(now);
    both.plant->master().write({.force_N = 1e6});
    both.plant->slave().write({});
    both.server->step(tick(++both.number));
  }
  EXPECT_LT(own, 60) << "10 ms of timeout";
  EXPECT_NE(both.plant->why_lost().message.find("at the master: commands insisted on more force"), std::string::npos)
      << both.plant->why_lost().message;
  EXPECT_EQ(both.server->status().released, 1);
  EXPECT_EQ(both.server->status().cause, station::ReleaseCause::force);
  EXPECT_GT(both.server->status().held_back, 40);
}

TEST(SharedPlant, AnotherExperimentIsRefusedByTheKeyThatDiffers) {
  const TappingParams params = short_taps();
  LockStep both(name_of("differs"), params, patient);
  const auto expect_refused = [&](const TappingParams& other, const char* word) {
    const Check refused = both.plant->check(other);
    ASSERT_TRUE(refused) << word;
    EXPECT_NE(refused->message.find(word), std::string::npos) << refused->message;
  };
  TappingParams other = params;
  other.servo.rate_Hz = 4000.0;
  expect_refused(other, "servo.rate_Hz is 4000.0 in this run and 5000.0 there");
  other = params;
  other.environment.position_m += 0.001;
  expect_refused(other, "environment.position_m");
  other = params;
  other.task.seed = 7;
  expect_refused(other, "task.seed is 7 in this run and 1 there");
  other = params;
  other.control.gate.force_limit_N = 20.0;
  expect_refused(other, "control.gate.force_limit_N is 20.0 in this run and 10.0 there");
  other = params;
  other.task.taps = 3;
  expect_refused(other, "task.taps=3");
  other = params;
  other.task.taps = 1;
  other.control.force_gain = 3.0;
  other.channel.to_slave.delay_s = 0.01;
  EXPECT_FALSE(both.plant->check(other)) << "what the controller does is its own affair";
}

TEST(SharedPlant, ASilenceIsBounded) {
  const auto plant = PlantServer::make(name_of("bounds"), short_taps(), Seconds{0.0});
  ASSERT_FALSE(plant);
  EXPECT_EQ(plant.error().place, "--silence-s");
  const auto shared = SharedPlant::attach(name_of("bounds"), Seconds{11.0});
  ASSERT_FALSE(shared);
  EXPECT_EQ(shared.error().place, "--plant-silence-s");
}

}  // namespace shared_plant_test
}  // namespace tactus::real_time
