// The same real-time loop with all observers and with none, in alternating windows: scripts/compare-with-observers.
#include <tactus/cli/ros2_session.hpp>
#include <tactus/configuration/document.hpp>
#include <tactus/live/live_view.hpp>
#include <tactus/live/server.hpp>
#include <tactus/ros2/bridge.hpp>
#include <tactus/runtime/servo_thread.hpp>
#include <tactus/telemetry/recorder.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <tests/live/raw_client.hpp>
#include <unistd.h>

namespace {

using namespace tactus;

struct Options {
  int windows = 8;
  double seconds = 5.0;
  std::int64_t core = 0;
  std::string experiment = "experiments/tapping.toml";
};

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "bench_observers: %s\n", why.c_str());
  std::exit(2);
}

template <class T>
T demand(Result<T> result) {
  if (!result) give_up(describe(result.error()));
  return *std::move(result);
}

/// What watches the loop: a client in the Foxglove protocol that subscribes to everything and reads it all.
class Watcher {
 public:
  explicit Watcher(std::uint16_t port) : client_(port) {
    if (!client_.open(port)) give_up("the live server did not take the client");
    client_.say(
        R"({"op":"advertise","channels":[{"id":1,"topic":"/operator/command","encoding":"json","schemaName":""}]})");
    std::string all;
    for (int topic = 1; topic <= 8; ++topic) {
      const std::string number = std::to_string(topic);
      if (topic > 1) all += ',';
      all.append(R"({"id":)").append(number).append(R"(,"channelId":)").append(number).append("}");
    }
    client_.say(R"({"op":"subscribe","subscriptions":[)" + all + "]}");
    thread_ = std::thread([this] {
      while (const auto message = client_.next(1000)) messages_ += message->binary ? 1 : 0;
    });
  }
  void join() { thread_.join(); }
  void tap() const { client_.say_binary(std::string("\x01\x01\x00\x00\x00", 5) + R"({"command":"tap"})"); }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  live::RawClient client_;
  std::atomic<std::uint64_t> messages_{0};
  std::thread thread_;
};

/// What the observers saw of a window, to show that they did watch.
struct Seen {
  std::uint64_t logged = 0, log_dropped = 0, shown = 0, live_dropped = 0, published = 0, ros2_dropped = 0;
  void add(const Seen& other) {
    logged += other.logged;
    log_dropped += other.log_dropped;
    shown += other.shown;
    live_dropped += other.live_dropped;
    published += other.published;
    ros2_dropped += other.ros2_dropped;
  }
};

std::unique_ptr<live::LiveView> make_view(const Options& options) {
  const auto document = demand(configuration::Document::load(options.experiment));
  return demand(live::LiveView::make(demand(live::Settings::make(document)), {.experiment = "tapping"}));
}

/// Steps `step` for a window on a servo thread, with a tap each second.
template <class Step, class Tap>
runtime::ServoReport window(const Options& options, const live::Engine& engine, Step step, const Tap& tap) {
  auto servo = demand(
      runtime::ServoThread<Step>::start({.rate_Hz = 1.0 / engine.tick_s(), .core = options.core}, std::move(step)));
  for (double left_s = options.seconds; left_s > 0.0; left_s -= 1.0) {
    tap();
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(1.0, left_s)));
  }
  servo->stop();
  return servo->finish();
}

runtime::ServoReport unobserved(const Options& options) {
  const auto view = make_view(options);
  live::Engine& engine = view->engine();
  return window(
      options, engine,
      [&engine](const runtime::Tick&) noexcept {
        engine.step();
        return true;
      },
      [&view] { view->receive(1, "/operator/command", "json", R"({"command":"tap"})"); });
}

runtime::ServoReport observed(const Options& options, Seen& seen) {
  const auto file = std::filesystem::temp_directory_path() / ("bench_observers_" + std::to_string(getpid()) + ".mcap");
  const auto view = make_view(options);
  live::Engine& engine = view->engine();
  auto log = demand(telemetry::Recorder::create(file));
  engine.log_to(log);
  log.start();
  auto bridge = demand(ros2::Bridge::create({.network = demand(ros2::network_of(ros2::environment()))}));
  runtime::ServoReport report;
  Seen now;
  {
    std::optional<live::Server> server(demand(live::Server::start({.port = 0, .conversation = {}}, {}, *view)));
    Watcher watcher(server->port());
    report = window(
        options, engine,
        [&engine, &bridge](const runtime::Tick& tick) noexcept {
          engine.step();
          bridge.publish(cli::snapshot_of(engine.newest(0), tick.deadline_ns, true));
          static_cast<void>(bridge.take_wish());
          return true;
        },
        [&watcher] { watcher.tap(); });
    now.live_dropped = server->counts().dropped + engine.dropped(0) + engine.dropped(1);
    server.reset();
    watcher.join();
    now.shown = watcher.messages();
  }
  bridge.close();
  now.published = bridge.counts().published;
  now.ros2_dropped = bridge.counts().dropped;
  if (const auto error = log.stop()) give_up(describe(*error));
  now.logged = log.log().acknowledged();
  for (const std::uint64_t dropped : log.dropped()) now.log_dropped += dropped;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  seen.add(now);
  return report;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

Options read_options(int count, char** words) {
  Options options;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = words[i];
    if (name == "--windows")
      options.windows = std::max(1, std::atoi(words[i + 1]));
    else if (name == "--seconds")
      options.seconds = std::max(1.0, std::atof(words[i + 1]));
    else if (name == "--core")
      options.core = std::atoi(words[i + 1]);
    else if (name == "--experiment")
      options.experiment = words[i + 1];
    else
      give_up("unknown option " + name + ": choose among --windows, --seconds, --core, --experiment");
  }
  if (count % 2 == 0) give_up("each option has one value");
  return options;
}

}  // namespace

int main(int count, char** words) {
  const Options options = read_options(count, words);
  std::vector<runtime::ServoReport> on, off;
  Seen seen;
  for (int i = 0; i < options.windows; ++i) {
    // Which of the two comes first changes too.
    if (i % 2 == 1) on.push_back(observed(options, seen));
    off.push_back(unobserved(options));
    if (i % 2 == 0) on.push_back(observed(options, seen));
  }
  std::printf("Two loops on one servo thread, us; medians of %d windows of %g s each, core %d\n", options.windows,
              options.seconds, static_cast<int>(options.core));
  std::printf("%-16s%10s%10s%8s%22s   goal\n", "", "all off", "all on", "ratio", "ratio, each window");
  const auto row = [&](const char* name, auto histogram, double q) {
    std::vector<double> with, without, ratio;
    for (std::size_t i = 0; i < on.size(); ++i) {
      with.push_back(1e-3 * (on[i].*histogram).quantile_ns(q));
      without.push_back(1e-3 * (off[i].*histogram).quantile_ns(q));
      ratio.push_back(with.back() / without.back());
    }
    const double overall = median(with) / median(without);
    const auto [least, most] = std::minmax_element(ratio.begin(), ratio.end());
    std::printf("%-16s%10.2f%10.2f%8.3f%13.3f to %5.3f   <= 1.05: %s\n", name, median(without), median(with), overall,
                *least, *most, overall <= 1.05 ? "reached" : "missed");
  };
  row("step, p50", &runtime::ServoReport::duration, 0.5);
  row("step, p99", &runtime::ServoReport::duration, 0.99);
  row("lateness, p50", &runtime::ServoReport::lateness, 0.5);
  row("lateness, p99", &runtime::ServoReport::lateness, 0.99);
  runtime::ServoReport with = on.front(), without = off.front();
  for (std::size_t i = 1; i < on.size(); ++i) {
    with.add(on[i]);
    without.add(off[i]);
  }
  std::printf("late ticks: all off %lld of ours, %lld of the machine's; all on %lld and %lld; of %lld and %lld ticks\n",
              static_cast<long long>(without.late_ours()), static_cast<long long>(without.late_machine()),
              static_cast<long long>(with.late_ours()), static_cast<long long>(with.late_machine()),
              static_cast<long long>(without.ticks), static_cast<long long>(with.ticks));
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "seen: log %llu records (%llu dropped), live client %llu messages (%llu dropped), ROS 2 %llu snapshots "
      "(%llu dropped)\n",
      number(seen.logged), number(seen.log_dropped), number(seen.shown), number(seen.live_dropped),
      number(seen.published), number(seen.ros2_dropped));
  for (const auto& right : on.front().rights) {
    if (!right.held) std::printf("not granted: %s\n", right.what.c_str());
  }
  return 0;
}
