#include <tactus/configuration/toml_writer.hpp>
#include <tactus/experiments/tapping/tapping.hpp>
#include <tactus/runtime/plant_server.hpp>
#include <tactus/runtime/real_time_tap.hpp>
#include <tactus/runtime/replay.hpp>
#include <tactus/runtime/shared_plant.hpp>
#include <tactus/telemetry/log_reader.hpp>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::runtime {
namespace shared_plant_test {

using namespace std::chrono_literals;
using experiments::TappingEnsemble;
using experiments::TappingParams;
using Record = simulation::Teleoperator::Record;

constexpr double observation_s = 0.15;
/// Two processes share two loaded cores: what is long for a machine that keeps time is not for this one.
constexpr Seconds patient{5.0};

/// A firm tap on a stiff wall with noise and tremor; at a rate that sanitizers keep up with.
TappingParams short_taps(double rate_Hz = 5000.0) {
  TappingParams params;
  params.task.taps = 2;
  params.task.observation_s = observation_s;
  params.task.slowest_m_per_s = 0.07;
  params.control.force_limit_N = 1.0;
  params.slave.force_sensor.noise_rms_N = 0.002;
  params.servo.rate_Hz = rate_Hz;
  return params;
}

std::string name_of(const char* test) { return std::string("test-") + test + "-" + std::to_string(getpid()); }

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
  EXPECT_EQ(both.server->status().let_go, 0);
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
  EXPECT_EQ(both.server->status().let_go, 0) << "within its bound";
  both.server->step(tick(++both.number));
  EXPECT_EQ(both.server->status().let_go, 1);
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
  EXPECT_EQ(both.server->status().let_go, 1);
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
  EXPECT_LT(own, 60) << "10 ms of patience";
  EXPECT_NE(both.plant->why_lost().message.find("at the master: commands insisted on more force"), std::string::npos)
      << both.plant->why_lost().message;
  EXPECT_EQ(both.server->status().let_go, 1);
  EXPECT_EQ(both.server->status().cause, station::LetGo::force);
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
  const auto servo = ServoThread<decltype(step)>::start({.rate_Hz = params.servo.rate_Hz, .priority = 10}, step);
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
    const RealTimeStreams streams{.sites = &recorder->add<SitesRecord>("/sites", "tactus_msgs/msg/SitesRecord"),
                                  .origin_ns = monotonic_ns()};
    recorder->start();
    auto made = RealTimeTap::make(ensemble->tap(0), observation_s, *plant, streams);
    ASSERT_TRUE(made);
    RealTimeTap& running = **made;
    const auto report = run_servo({.rate_Hz = slow_Hz, .priority = 10}, [&](const station::Tick& now) noexcept {
      if (!running.trace().empty() && running.trace().back().contact_force_N > 0.3) kill(child, SIGKILL);
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
    const auto report = run_servo({.rate_Hz = slow_Hz, .priority = 10},
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
  const auto servo = ServoThread<decltype(step)>::start({.rate_Hz = slow_Hz, .priority = 10}, step);
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
  EXPECT_TRUE(serve_until([&] { return plant.status().let_go == 1; }));
  EXPECT_FALSE(plant.status().controller);
  heir.go();
  int status = -1;
  EXPECT_TRUE(serve_until([&] { return waitpid(heir.process, &status, WNOHANG) == heir.process; }));
  EXPECT_EQ(status, 0);
  EXPECT_EQ(plant.status().taps, 2);
  EXPECT_EQ(plant.status().let_go, 1);
  (*servo)->stop();
  (*servo)->finish();
}

}  // namespace shared_plant_test
}  // namespace tactus::runtime
