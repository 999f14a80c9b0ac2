// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/simulation/real_time/plant_server.hpp>
#include <tactus/simulation/real_time/real_time_tap.hpp>
#include <tactus/simulation/real_time/replay.hpp>
#include <tactus/simulation/real_time/shared_plant.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/real_time/shared_plant_test.hpp"
#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

/// What is left when either process dies.
namespace tactus::real_time {
namespace shared_plant_test {

using namespace std::chrono_literals;
using experiments::TappingEnsemble;
using experiments::TappingParams;

constexpr double slow_Hz = 1000.0;

/// A process with a plant, in real time, until it is killed.
pid_t start_plant(const std::string& name, const TappingParams& params, Seconds silence) {
  const pid_t child = fork();
  if (child != 0) return child;
  alarm(120);
  const auto server = PlantServer::make(name, params, silence);
  if (!server) _exit(2);
  PlantServer& plant = **server;
  const auto step = [&plant](const station::Tick& now) noexcept {
    plant.step(now);
    return true;
  };
  const auto servo =
      runtime::ServoThread<decltype(step)>::start({.rate_Hz = params.servo.rate_Hz, .priority = 10}, step);
  if (!servo) _exit(3);
  for (;;) {
    plant.serve();
    std::this_thread::sleep_for(1ms);
  }
}

/// Once it is there.
std::unique_ptr<SharedPlant> attach(const std::string& name, Seconds silence) {
  for (int i = 0; i < 2000; ++i) {
    if (auto plant = SharedPlant::attach(name, silence)) return *std::move(plant);
    std::this_thread::sleep_for(10ms);
  }
  return nullptr;
}

void end(pid_t child) {
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

TEST(SharedPlant, WhenThePlantIsKilledInMidRunBothSitesLetGoAtTheRateLimitAndTheLogReplays) {
  TappingParams params = short_taps(slow_Hz);
  params.control.gate.rate_limit_N_per_s = 50.0;
  params.control.slave_gate.rate_limit_N_per_s = 200.0;
  const std::string name = name_of("killed");
  const pid_t child = start_plant(name, params, patient);
  const auto plant = attach(name, Seconds{2.0});
  ASSERT_TRUE(plant);
  ASSERT_FALSE(plant->begin(0));
  const auto ensemble = TappingEnsemble::make(params);
  const auto file = scratch_path().concat(".mcap");
  {
    auto recorder = telemetry::Recorder::create(file);
    ASSERT_TRUE(recorder);
    recorder->add_metadata("tactus", {{"configuration", configuration::to_toml(params)}});
    const runtime::RealTimeStreams streams{
        .sites = &recorder->add<runtime::SitesRecord>("/sites", "tactus_msgs/msg/SitesRecord"),
        .origin_ns = runtime::monotonic_ns()};
    recorder->start();
    auto made = RealTimeTap::make(ensemble->tap(0), observation_s, *plant, streams);
    ASSERT_TRUE(made);
    RealTimeTap& running = **made;
    const auto report =
        runtime::run_servo({.rate_Hz = slow_Hz, .priority = 10}, [&](const station::Tick& now) noexcept {
          // Once there is a force at either motor: the gates let it rise by 0.05 and 0.2 N a tick.
          if (!running.trace().empty() && std::fabs(running.trace().back().displayed_force_N) > 0.15)
            kill(child, SIGKILL);
          return running.step(now);
        });
    ASSERT_TRUE(report);
    ASSERT_FALSE(recorder->stop());
  }
  end(child);
  EXPECT_TRUE(plant->lost());
  EXPECT_NE(plant->why_lost().message.find("died"), std::string::npos) << plant->why_lost().message;

  EXPECT_TRUE(PlantServer::make(name, params, patient)) << "the next one takes its place, and leaves nothing";

  const auto log = telemetry::read_log(file);
  const auto replayed = replay(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(log);
  ASSERT_TRUE(replayed) << describe(replayed.error());
  EXPECT_FALSE(replayed->difference);
  const auto& table = log->tables.at(0);
  const auto column = [&](const std::string& signal) -> const std::vector<double>& {
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (table.columns[i].name == signal) return table.values[i];
    }
    throw std::out_of_range(signal);
  };
  const auto& missed = column("missed");
  ASSERT_GT(missed.size(), 100U) << "it went on after the plant was gone";
  const auto expect_gentle = [&](const char* signal, double limit_N_per_s) {
    const std::vector<double>& force = column(signal);
    double before = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      ASSERT_TRUE(std::isfinite(force[i])) << signal << " at " << i;
      ASSERT_LE(std::fabs(force[i] - before), limit_N_per_s / slow_Hz * (1.0 + 1e-9)) << signal << " at " << i;
      before = force[i];
      largest = std::max(largest, std::fabs(before));
    }
    EXPECT_GT(largest, 0.1) << signal << ": there was something to let go";
    EXPECT_EQ(force.back(), 0.0) << signal;
  };
  expect_gentle("master_force_N", params.control.gate.rate_limit_N_per_s);
  expect_gentle("slave_force_N", params.control.slave_gate.rate_limit_N_per_s);
}

/// A process that drives one tap once it is told to; its status is 0 where it touched the wall.
class Controller {
 public:
  Controller(const std::string& name, const TappingParams& params) {
    EXPECT_EQ(pipe(ends_), 0);
    process = fork();
    if (process != 0) return;
    alarm(120);
    char told = 0;
    if (read(ends_[0], &told, 1) != 1) _exit(1);
    const auto plant = attach(name, patient);
    const auto ensemble = TappingEnsemble::make(params);
    if (!plant || !ensemble || plant->begin(0)) _exit(2);
    auto made = RealTimeTap::make(ensemble->tap(0), params.task.observation_s, *plant);
    if (!made) _exit(3);
    RealTimeTap& running = **made;
    const auto report = runtime::run_servo({.rate_Hz = slow_Hz, .priority = 10},
                                           [&running](const station::Tick& now) noexcept { return running.step(now); });
    _exit(report && !plant->lost() && running.result().touched ? 0 : 4);
  }
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;
  ~Controller() {
    end(process);
    close(ends_[0]);
    close(ends_[1]);
  }
  void go() const { EXPECT_EQ(write(ends_[1], "!", 1), 1); }
  pid_t process = -1;

 private:
  int ends_[2]{};
};

TEST(SharedPlant, WhenTheControllerIsKilledInMidRunThePlantLetsGoAndTheNextOneTaps) {
  TappingParams params = short_taps(slow_Hz);
  params.task.observation_s = 2.0;
  const std::string name = name_of("orphan");
  // The plant is in this process, so that its threads come after the forks.
  const Controller first(name, params), heir(name, params);
  const auto server = PlantServer::make(name, params, Seconds{2.0});
  ASSERT_TRUE(server) << describe(server.error());
  PlantServer& plant = **server;
  const auto step = [&plant](const station::Tick& now) noexcept {
    plant.step(now);
    return true;
  };
  const auto servo = runtime::ServoThread<decltype(step)>::start({.rate_Hz = slow_Hz, .priority = 10}, step);
  ASSERT_TRUE(servo);
  const auto serve_until = [&plant](auto&& condition) {
    for (int i = 0; i < 30'000; ++i) {
      if (condition()) return true;
      plant.serve();
      std::this_thread::sleep_for(1ms);
    }
    return false;
  };
  first.go();
  ASSERT_TRUE(serve_until([&] { return plant.status().commands > 100; }));
  EXPECT_EQ(plant.status().controller, first.process);
  kill(first.process, SIGKILL);
  EXPECT_TRUE(serve_until([&] { return plant.status().released == 1; }));
  EXPECT_FALSE(plant.status().controller);
  heir.go();
  int status = -1;
  EXPECT_TRUE(serve_until([&] { return waitpid(heir.process, &status, WNOHANG) == heir.process; }));
  EXPECT_EQ(status, 0);
  EXPECT_EQ(plant.status().taps, 2);
  EXPECT_EQ(plant.status().released, 1);
  (*servo)->stop();
  (*servo)->finish();
}

}  // namespace shared_plant_test
}  // namespace tactus::real_time
