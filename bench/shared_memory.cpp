// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/runtime/servo/shared_device.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <array>
#include <atomic>
#include <cstdio>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

// Round trips through memory between two threads that spin, in alternating windows of one run: two bare atomics, and a
// command with the reading that answers it, as a controller and the owner of a device exchange them. Shared memory of
// two processes is the same memory as that of two threads. The last column is the work alone: both sides in one thread.

namespace {

using namespace tactus::runtime;
using tactus::report::number;
using tactus::simulation::quantile;

constexpr int windows = 41;
constexpr tactus::Seconds silence{10.0};

tactus::station::Tick now() { return {.began_ns = monotonic_ns()}; }

/// What is exchanged: the one side tells a number and asks whether it has come back, the other one answers.
struct Contestant {
  const char* name;
  std::function<void(double)> tell;
  std::function<void()> answer;
  std::function<bool(double)> came_back;
  std::vector<double> two_threads_us{}, one_thread_us{};
};

double elapsed_us(std::int64_t since_ns) { return 1e-3 * static_cast<double>(monotonic_ns() - since_ns); }

double one_thread(const Contestant& contestant, double& told) {
  constexpr int trips = 2000;
  const std::int64_t began_ns = monotonic_ns();
  for (int i = 0; i < trips; ++i) {
    contestant.tell(++told);
    contestant.answer();
    while (!contestant.came_back(told)) {
    }
  }
  return elapsed_us(began_ns) / trips;
}

/// Median over bundles, so that the clock is not what is measured.
double two_threads(const Contestant& contestant, double& told) {
  constexpr int bundle = 20;
  std::atomic<bool> stop{false};
  std::thread answering([&] {
    while (!stop.load(std::memory_order_relaxed)) contestant.answer();
  });
  std::vector<double> bundles_us;
  const std::int64_t window_ns = monotonic_ns();
  while (elapsed_us(window_ns) < 20'000.0) {
    const std::int64_t began_ns = monotonic_ns();
    for (int i = 0; i < bundle; ++i) {
      contestant.tell(++told);
      while (!contestant.came_back(told)) {
      }
    }
    bundles_us.push_back(elapsed_us(began_ns) / bundle);
  }
  stop = true;
  answering.join();
  return quantile(bundles_us, 0.5);
}

}  // namespace

/// bench_shared_memory: prints a table.
int main() {
  alignas(64) std::atomic<double> there{0.0};
  alignas(64) std::atomic<double> back{0.0};
  const auto slots = std::make_unique<DeviceSlots>();
  DeviceServer owner(*slots, silence);
  SharedDevice controller(*slots, {.force_N = 1.0}, silence);
  owner.begin(1);
  controller.begin(1);
  // The clock of a tick is the servo thread's; here it stands, and readings are told apart by what they say.
  tactus::station::Tick tick = now();
  owner.publish(tick, 0, {});
  (void)controller.read(tick);

  std::array contestants{
      Contestant{.name = "two bare atomics",
                 .tell = [&](double told) { there.store(told, std::memory_order_release); },
                 .answer = [&] { back.store(there.load(std::memory_order_acquire), std::memory_order_release); },
                 .came_back = [&](double told) { return back.load(std::memory_order_acquire) == told; }},
      Contestant{.name = "command and reading",
                 .tell = [&](double told) { controller.write({.force_N = told}); },
                 .answer =
                     [&, answered = 0.0, number = std::int64_t{0}]() mutable {
                       const double told = owner.command(tick).force_N;
                       if (told == answered) return;
                       answered = told;
                       ++number;
                       owner.publish({.began_ns = tick.began_ns + number}, number, {.position_m = told});
                     },
                 .came_back = [&](double told) { return controller.read(tick).position_m == told; }}};
  double told = 0.0;
  for (int window = 0; window < windows; ++window) {
    for (Contestant& contestant : contestants) {
      contestant.one_thread_us.push_back(one_thread(contestant, told));
      contestant.two_threads_us.push_back(two_threads(contestant, told));
    }
  }

  // The ratio is that of neighbouring windows; the machine's speed drifts over a run.
  std::vector<double> ratios;
  for (std::size_t i = 0; i < windows; ++i) {
    ratios.push_back(contestants[1].two_threads_us[i] / contestants[0].two_threads_us[i]);
  }
  tactus::report::Table table({{"round trip", "", tactus::report::Column::Align::left},
                               {"two threads", "us"},
                               {"both sides in one thread", "us"}},
                              "A device that another process owns");
  for (const Contestant& c : contestants) {
    table.add_row({c.name, number(quantile(c.two_threads_us, 0.5), 3), number(quantile(c.one_thread_us, 0.5), 3)});
  }
  std::printf("%s\nCommand and reading over two bare atomics, median of neighbouring windows: %s\n",
              table.to_text().c_str(), number(quantile(ratios, 0.5), 3).c_str());
  return 0;
}
