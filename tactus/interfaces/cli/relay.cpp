// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/json_option.hpp>
#include <tactus/interfaces/cli/passages.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>
#include <tactus/runtime/link/socket.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iostream>
#include <memory>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <poll.h>

namespace tactus::cli {

namespace {

/// More than this waits nowhere: ten seconds of a fast servo.
constexpr std::size_t longest_queue = 100'000;

struct RelayOptions {
  std::string file;
  std::vector<std::string> set;
  std::string master;
  std::string slave;
  std::string for_master;
  std::string for_slave;
  double mean_burst = 0.0;
  double duplicate_fraction = 0.0;
  double duration_s = 0.0;
  JsonOption json;
};

/// One way through the relay: each packet is lost, late or doubled as the seed draws.
class RelayDirection {
 public:
  struct Counters {
    std::uint64_t arrived = 0, lost = 0, doubled = 0, overflowed = 0, passed = 0;
  };

  RelayDirection(const station::Channel::Params& params, double mean_burst, double duplicate_fraction)
      : delay_ns_(params.delay_s * 1e9),
        jitter_ns_(params.jitter_s * 1e9),
        duplicate_fraction_(duplicate_fraction),
        passages_(params.loss_fraction, mean_burst, params.jitter_s > 0.0, params.seed),
        doubles_(signal::Random(static_cast<std::uint64_t>(params.seed)).fork(0)) {}

  void take(const link::Received& packet, std::int64_t now_ns) {
    ++counters_.arrived;
    if (duplicate_fraction_ > 0.0 && doubles_.uniform() < duplicate_fraction_) {
      ++counters_.doubled;
      hold(packet, now_ns);
    }
    hold(packet, now_ns);
  }

  void pass(const link::Socket& to, std::int64_t now_ns) {
    while (!waiting_.empty() && waiting_.top().due_ns <= now_ns) {
      to.send(waiting_.top().bytes);
      ++counters_.passed;
      waiting_.pop();
    }
  }

  /// When the next packet is due; `otherwise_ns` where none waits.
  [[nodiscard]] std::int64_t next_ns(std::int64_t otherwise_ns) const {
    return waiting_.empty() ? otherwise_ns : std::min(otherwise_ns, waiting_.top().due_ns);
  }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Waiting {
    std::int64_t due_ns;
    std::uint64_t number;
    std::vector<std::byte> bytes;
    bool operator<(const Waiting& other) const {
      return std::pair(other.due_ns, other.number) < std::pair(due_ns, number);
    }
  };

  void hold(const link::Received& packet, std::int64_t now_ns) {
    const auto [lost, jitter_share] = passages_.next();
    if (lost) {
      ++counters_.lost;
    } else if (waiting_.size() >= longest_queue) {
      ++counters_.overflowed;
    } else {
      const auto bytes = packet.bytes();
      waiting_.push({.due_ns = now_ns + static_cast<std::int64_t>(delay_ns_ + jitter_share * jitter_ns_),
                     .number = ++number_,
                     .bytes = {bytes.begin(), bytes.end()}});
    }
  }

  double delay_ns_;
  double jitter_ns_;
  double duplicate_fraction_;
  Passages passages_;
  signal::Random doubles_;
  std::uint64_t number_ = 0;
  std::priority_queue<Waiting> waiting_;
  Counters counters_;
};

Result<link::Socket> socket_between(const std::string& local, const std::string& peer) {
  const auto from = link::Address::parse(local);
  if (!from) return from.error();
  const auto to = link::Address::parse(peer);
  if (!to) return to.error();
  return link::Socket::open(*from, *to);
}

void wait(const link::Socket& one, const link::Socket& other, std::int64_t longest_ns) {
  std::array<pollfd, 2> both{pollfd{.fd = one.descriptor(), .events = POLLIN, .revents = 0},
                             pollfd{.fd = other.descriptor(), .events = POLLIN, .revents = 0}};
  const timespec longest{.tv_sec = longest_ns / 1'000'000'000, .tv_nsec = longest_ns % 1'000'000'000};
  ppoll(both.data(), both.size(), &longest, nullptr);
}

void print(const RelayDirection::Counters& to_slave, const RelayDirection::Counters& to_master, const JsonOption& json,
           const std::string& configuration) {
  const std::array<std::pair<const char*, const RelayDirection::Counters*>, 2> ways{
      {{"to_slave", &to_slave}, {"to_master", &to_master}}};
  nlohmann::ordered_json document;
  report::Table table(
      {{"way", "", report::Column::Align::left}, {"came"}, {"lost"}, {"doubled"}, {"found no room"}, {"passed on"}},
      "Relay");
  for (const auto& [name, c] : ways) {
    document[name] = {{"arrived", c->arrived},
                      {"lost", c->lost},
                      {"doubled", c->doubled},
                      {"overflowed", c->overflowed},
                      {"passed", c->passed}};
    table.add_row({name, std::to_string(c->arrived), std::to_string(c->lost), std::to_string(c->doubled),
                   std::to_string(c->overflowed), std::to_string(c->passed)});
  }
  std::cout << (json.wanted ? json.document(report::json_text(document), configuration) : table.to_text());
}

Check run(const RelayOptions& options) {
  auto document = with_set(configuration::Document::load(options.file), options.set);
  if (!document) return document.error();
  const auto params = document->read<experiments::TappingParams>();
  if (!params) return params.error();
  auto master = socket_between(options.for_master, options.master);
  if (!master) return master.error();
  auto slave = socket_between(options.for_slave, options.slave);
  if (!slave) return slave.error();

  RelayDirection to_slave(params->channel.to_slave, options.mean_burst, options.duplicate_fraction);
  RelayDirection to_master(params->channel.to_master, options.mean_burst, options.duplicate_fraction);
  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();
  constexpr std::int64_t look_up_ns = 50'000'000;
  const std::int64_t start_ns = link::monotonic_ns();
  while (!end.asked()) {
    std::int64_t now_ns = link::monotonic_ns();
    if (options.duration_s > 0.0 && static_cast<double>(now_ns - start_ns) > options.duration_s * 1e9) break;
    for (const link::Received& packet : master->receive()) to_slave.take(packet, now_ns);
    for (const link::Received& packet : slave->receive()) to_master.take(packet, now_ns);
    to_slave.pass(*slave, now_ns);
    to_master.pass(*master, now_ns);
    now_ns = link::monotonic_ns();
    const std::int64_t next_ns = to_master.next_ns(to_slave.next_ns(now_ns + look_up_ns));
    wait(*master, *slave, std::max<std::int64_t>(0, next_ns - now_ns));
  }
  print(to_slave.counters(), to_master.counters(), options.json, configuration::to_toml(*params));
  return flush_standard_output();
}

}  // namespace

void add_relay(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<RelayOptions>();
  CLI::App* verb =
      app.add_subcommand("relay", "Relay packets between two sites with loss, delay, reordering and duplication");
  verb->add_option("EXPERIMENT", options->file, "Experiment file whose section [channel] describes the network")
      ->required();
  add_set_option(*verb, options->set);
  const auto address = [&](const char* name, std::string& value, const char* help) {
    verb->add_option(name, value, help)->type_name("HOST:PORT")->required();
  };
  address("--master", options->master, "Address on which the master listens");
  address("--for-master", options->for_master,
          "Address on which the relay listens for the master: the master's --peer");
  address("--slave", options->slave, "Address on which the slave listens");
  address("--for-slave", options->for_slave, "Address on which the relay listens for the slave: the slave's --peer");
  verb->add_option("--mean-burst", options->mean_burst,
                   "Mean number of packets lost in a row; at 1 or less, losses are independent")
      ->check(real_between(0.0, 10000.0));
  verb->add_option("--duplicate-fraction", options->duplicate_fraction, "Share of the packets that are sent twice")
      ->check(real_between(0.0, 1.0));
  verb->add_option("--duration-s", options->duration_s, "Time to run; 0: until interrupted")
      ->type_name("S")
      ->check(real_between(0.0, 1e6));
  add_json_option(*verb, options->json, command);
  verb->callback([options, &app, &status] {
    if (const auto error = run(*options)) {
      std::cerr << app.get_name() << ": " << describe(*error) << "\n";
      status = exit_status(*error);
    }
  });
}

}  // namespace tactus::cli
