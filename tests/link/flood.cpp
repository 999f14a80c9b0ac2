// SPDX-License-Identifier: Apache-2.0
// flood_link [PACKETS [PER_SECOND]]: an encrypted link of two sites at 5 kHz, and an attacker on the way who sends so
// many hostile packets to the slave. Windows of a second take turns: quiet, the same flood to a port that has nothing
// to do with the link, the flood. Prints what was accepted, the slave's time for receiving and sending in a tick, and
// its memory. Status 1 where anything was accepted, the link did not go on, or memory grew.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <utility>
#include <vector>

#include <malloc.h>
#include <tests/link/between.hpp>

namespace {

using namespace tactus::link;

constexpr std::int64_t tick_ns = 200'000;
constexpr std::int64_t window_ns = 1'000'000'000;

/// What the attacker does.
enum class Phase : std::uint8_t { quiet, elsewhere, flooded };
constexpr std::array phase_names{"quiet", "elsewhere", "flooded"};
using Times = std::array<std::vector<double>, phase_names.size()>;

double quantile(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// Quantiles of the time of a tick in us, and what they are of those of the quiet windows.
void print_times(Times& times_us) {
  for (auto& times : times_us) std::sort(times.begin(), times.end());
  const auto& quiet = times_us[0];
  for (std::size_t i = 0; i < times_us.size(); ++i) {
    std::printf("%-10s %9zu ticks", phase_names[i], times_us[i].size());
    for (const auto& [name, share] : {std::pair{"p50", 0.5}, {"p99", 0.99}, {"p99.9", 0.999}}) {
      const double at_us = quantile(times_us[i], share);
      std::printf("   %s %7.2f us (%.2f)", name, at_us, at_us / quantile(quiet, share));
    }
    std::printf("\n");
  }
}

/// A site that ticks until it is told to stop.
class TickingSite {
 public:
  TickingSite(Endpoint& endpoint, const std::atomic<Phase>& phase, std::size_t most_ticks)
      : endpoint_(endpoint), phase_(phase) {
    for (auto& times : times_us) times.reserve(most_ticks);
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    stop_ = true;
    thread_.join();
  }
  Times times_us;
  std::uint64_t wrong = 0;  ///< messages that nobody sent

 private:
  void run() {
    std::int64_t deadline_ns = monotonic_ns();
    while (!stop_) {
      deadline_ns = std::max(deadline_ns + tick_ns, monotonic_ns());
      const timespec deadline{.tv_sec = deadline_ns / 1'000'000'000, .tv_nsec = deadline_ns % 1'000'000'000};
      clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
      const std::int64_t began_ns = monotonic_ns();
      const auto received = testing::tick(endpoint_, 1.0);
      const double took_us = static_cast<double>(monotonic_ns() - began_ns) * 1e-3;
      auto& times = times_us[static_cast<std::size_t>(phase_.load())];
      if (times.size() < times.capacity()) times.push_back(took_us);
      if (received && received->message.position_m != 1.0) ++wrong;
    }
  }
  Endpoint& endpoint_;
  const std::atomic<Phase>& phase_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace

int main(int count, char** arguments) {
  const long long packets = count > 1 ? std::atoll(arguments[1]) : 10'000'000;
  const double per_second = count > 2 ? std::atof(arguments[2]) : 50'000.0;
  testing::Between between;
  if (packets <= 0 || !(per_second > 0.0) || !between.meet()) {
    std::fprintf(stderr, "flood_link: the sites did not meet; use: flood_link [PACKETS [PER_SECOND]]\n");
    return 2;
  }
  const auto most_ticks = static_cast<std::size_t>(static_cast<double>(packets) / per_second * 5000.0 * 1.5) + 10'000;
  std::atomic<Phase> phase{Phase::quiet};
  TickingSite slave(*between.slave, phase, most_ticks);
  TickingSite master(*between.master, phase, 1);

  long long sent = 0, sent_elsewhere = 0;
  std::size_t memory_before = 0;
  std::array<double, phase_names.size()> lasted_s{};
  std::int64_t last_ns = monotonic_ns(), window_end_ns = last_ns + 2 * window_ns;
  while (sent < packets) {
    between.pass_on();
    const std::int64_t now_ns = monotonic_ns();
    const Phase now = phase;
    double& now_s = lasted_s[static_cast<std::size_t>(now)];
    now_s += static_cast<double>(now_ns - last_ns) * 1e-9;
    last_ns = now_ns;
    if (now_ns >= window_end_ns) {
      if (memory_before == 0) memory_before = mallinfo2().uordblks;
      phase = static_cast<Phase>((static_cast<std::size_t>(now) + 1) % phase_names.size());
      window_end_ns = now_ns + window_ns;
    }
    long long& counted = now == Phase::flooded ? sent : sent_elsewhere;
    for (int burst = 0; now != Phase::quiet && burst < 64; ++burst) {
      if (static_cast<double>(counted) >= now_s * per_second || sent >= packets) break;
      now == Phase::flooded ? between.attack() : between.attack_elsewhere();
      ++counted;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  phase = Phase::quiet;
  for (int i = 0; i < 10'000; ++i) {
    between.pass_on();
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  master.stop();
  slave.stop();

  const auto counters = between.slave->counters();
  const std::size_t memory = mallinfo2().uordblks;
  const bool accepted = counters.secure.opened > between.passed_to_slave || counters.malformed > 0 || slave.wrong > 0 ||
                        counters.inbound.sessions != 1;
  const bool went_on = counters.secure.handshakes >= 1 && counters.inbound.counted > 1000;
  const bool grew = memory > memory_before + 1'000'000;
  std::printf(
      "hostile packets sent %lld, %.0f a second; dropped by the kernel %llu, refused %llu, passed to the "
      "hand-shakes %llu, no room %llu\n",
      sent, static_cast<double>(sent) / lasted_s[static_cast<std::size_t>(Phase::flooded)],
      static_cast<unsigned long long>(between.slave->socket().dropped()),
      static_cast<unsigned long long>(counters.secure.refused),
      static_cast<unsigned long long>(counters.secure.handshake_packets),
      static_cast<unsigned long long>(counters.secure.overflowed));
  std::printf("accepted: %s; authentic %llu of %llu passed on; sessions %llu, hand-shakes %llu\n",
              accepted ? "SOME" : "0", static_cast<unsigned long long>(counters.secure.opened),
              static_cast<unsigned long long>(between.passed_to_slave),
              static_cast<unsigned long long>(counters.inbound.sessions),
              static_cast<unsigned long long>(counters.secure.handshakes));
  std::printf("heap: %zu bytes before, %zu after\n", memory_before, memory);
  print_times(slave.times_us);
  return accepted || !went_on || grew ? 1 : 0;
}
