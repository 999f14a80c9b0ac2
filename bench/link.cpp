// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/runtime/link/endpoint.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <sys/socket.h>
#include <tests/link/pair.hpp>

// Round trips on the loopback in alternating windows of one run: a bare UDP ping-pong of as many bytes, the link in
// plain text, and the link encrypted. Once with both ends in one thread, as the time of the processor that they take,
// and once with each end in a thread that spins on its socket, as two sites would.
//
// Before each of its windows a link ticks until it is at rest. It has been silent since the one before, and where a
// busy machine makes that longer than a quarter of a second, its master shakes hands anew: within a window that would
// be measured as encryption.

namespace {

using namespace tactus::link;
using tactus::report::number;

constexpr int windows = 41;

/// One end of a round trip: sends, and says whether an answer is there.
struct End {
  std::function<void()> send;
  std::function<bool()> came;
};

struct Bare {
  Socket socket;
  std::array<std::byte, datagram_bytes> sent{};
  std::array<std::byte, Received::longest> received{};
};

struct Contestant {
  const char* name;
  End left, right;
  std::function<void()> settle = [] {};  ///< before a window
  std::vector<double> one_thread_us{}, two_threads_us{};
};

/// What `Endpoint` does for a tick, in the two halves that a ping-pong has.
End end_of(Endpoint& endpoint) {
  return {.send = [&endpoint] { testing::send(endpoint, 1.0, monotonic_ns()); },
          .came = [&endpoint] { return !endpoint.receive(monotonic_ns()).empty(); }};
}

/// The barest: one system call to send, one to receive.
End end_of(Bare& bare) {
  return {.send = [&bare] { send(bare.socket.descriptor(), bare.sent.data(), bare.sent.size(), MSG_DONTWAIT); },
          .came =
              [&bare] {
                return recv(bare.socket.descriptor(), bare.received.data(), bare.received.size(), MSG_DONTWAIT) > 0;
              }};
}

double now_us() { return static_cast<double>(monotonic_ns()) * 1e-3; }
/// Of the processor, that this thread has taken.
double taken_us() {
  timespec taken{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &taken);
  return static_cast<double>(taken.tv_sec) * 1e6 + static_cast<double>(taken.tv_nsec) * 1e-3;
}
constexpr double longest_us = 20'000.0;  // what takes longer was lost

/// Lets both ends of a link tick until no hand-shake is under way, and takes what is left in the sockets.
void settle(Endpoint& left, Endpoint& right) {
  const auto counted = [&] { return std::min(left.counters().inbound.counted, right.counters().inbound.counted); };
  const auto handshakes = [&] { return left.counters().secure.handshakes + right.counters().secure.handshakes; };
  std::uint64_t before = 0;
  do {
    before = handshakes();
    const std::uint64_t least = counted() + 50;
    testing::tick_until(left, right, [&] { return counted() >= least; });
  } while (handshakes() != before);
  while (!left.receive(monotonic_ns()).empty() || !right.receive(monotonic_ns()).empty()) {
  }
}

/// Mean time of the processor for a round trip with both ends in this thread.
double one_thread(Contestant& contestant) {
  constexpr int trips = 300;
  const auto wait_for = [](End& end) {
    const double end_us = now_us() + longest_us;
    while (!end.came() && now_us() < end_us) {
    }
  };
  contestant.settle();
  const double began_us = taken_us();
  for (int i = 0; i < trips; ++i) {
    contestant.left.send();
    wait_for(contestant.right);
    contestant.right.send();
    wait_for(contestant.left);
  }
  return (taken_us() - began_us) / trips;
}

/// Median round trip with each end in a thread of its own.
double two_threads(Contestant& contestant) {
  contestant.settle();
  std::atomic<bool> stop{false};
  std::thread answering([&] {
    while (!stop.load(std::memory_order_relaxed)) {
      if (contestant.right.came()) contestant.right.send();
    }
  });
  std::vector<double> trips_us;
  const double end_us = now_us() + 30'000.0;
  while (now_us() < end_us) {
    const double began_us = now_us();
    contestant.left.send();
    double took_us = 0.0;
    bool came = false;
    while (!came && took_us < longest_us) {
      came = contestant.left.came();
      took_us = now_us() - began_us;
    }
    if (came) trips_us.push_back(took_us);
  }
  stop = true;
  answering.join();
  return trips_us.empty() ? longest_us : tactus::simulation::quantile(trips_us, 0.5);
}

}  // namespace

/// bench_link: prints a table.
int main() {
  testing::Ports bare_ports, plain_ports, secure_ports;
  const auto open_bare = [&](std::uint16_t own, std::uint16_t other) {
    return Bare{.socket = Socket::open(testing::loopback(own), testing::loopback(other)).value()};
  };
  Bare bare_left = open_bare(bare_ports.master, bare_ports.slave);
  Bare bare_right = open_bare(bare_ports.slave, bare_ports.master);
  Endpoint plain_left = testing::open(SiteRole::master, plain_ports, std::nullopt);
  Endpoint plain_right = testing::open(SiteRole::slave, plain_ports, std::nullopt);
  Endpoint secure_left = testing::open(SiteRole::master, secure_ports, testing::test_key());
  Endpoint secure_right = testing::open(SiteRole::slave, secure_ports, testing::test_key());
  if (!testing::meet(plain_left, plain_right) || !testing::meet(secure_left, secure_right)) {
    std::fputs("bench_link: the sites did not meet\n", stderr);
    return 1;
  }

  std::array<Contestant, 3> contestants{
      Contestant{.name = "bare UDP", .left = end_of(bare_left), .right = end_of(bare_right)},
      Contestant{.name = "link, plain text",
                 .left = end_of(plain_left),
                 .right = end_of(plain_right),
                 .settle = [&] { settle(plain_left, plain_right); }},
      Contestant{.name = "link, encrypted", .left = end_of(secure_left), .right = end_of(secure_right), .settle = [&] {
                   settle(secure_left, secure_right);
                 }}};
  for (int window = 0; window < windows; ++window) {
    for (Contestant& contestant : contestants) {
      contestant.one_thread_us.push_back(one_thread(contestant));
      contestant.two_threads_us.push_back(two_threads(contestant));
    }
  }

  // The ratio is that of neighbouring windows; the machine's speed drifts over a run.
  const auto ratio = [](const std::vector<double>& times, const std::vector<double>& bare) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < times.size(); ++i) ratios.push_back(times[i] / bare[i]);
    return tactus::simulation::quantile(ratios, 0.5);
  };
  using Align = tactus::report::Column::Align;
  tactus::report::Table table({{"round trip of " + std::to_string(datagram_bytes) + " bytes", "", Align::left},
                               {"one thread, processor", "us"},
                               {"over bare"},
                               {"two threads", "us"},
                               {"over bare"}},
                              "Two sites on the loopback");
  for (const Contestant& c : contestants) {
    table.add_row({c.name, number(tactus::simulation::quantile(c.one_thread_us, 0.5), 3),
                   number(ratio(c.one_thread_us, contestants[0].one_thread_us), 3),
                   number(tactus::simulation::quantile(c.two_threads_us, 0.5), 3),
                   number(ratio(c.two_threads_us, contestants[0].two_threads_us), 3)});
  }
  std::vector<double> encryption_us;
  for (std::size_t i = 0; i < contestants[2].one_thread_us.size(); ++i) {
    encryption_us.push_back(0.5 * (contestants[2].one_thread_us[i] - contestants[1].one_thread_us[i]));
  }
  std::printf("%s\nEncrypting, authenticating and opening one message: %s us\n", table.to_text().c_str(),
              number(tactus::simulation::quantile(encryption_us, 0.5), 3).c_str());
  return 0;
}
