// SPDX-License-Identifier: Apache-2.0
// The same real-time loop with observers, with none, and beside a load that has nothing to do with it, in alternating
// windows: scripts/compare-with-observers.
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/telemetry/recorder.hpp>
#include <tactus/interfaces/live/live_view.hpp>
#include <tactus/interfaces/live/server.hpp>
#include <tactus/runtime/ros2/observer.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>

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

#include <sys/resource.h>
#include <tests/live/raw_client.hpp>
#include <time.h>
#include <unistd.h>

namespace {

using namespace tactus;

struct Options {
  int windows = 8;
  double seconds = 5.0;
  std::int64_t core = 0;
  bool each = false;
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

/// What the other threads of the process used beside the servo thread, per second of a window.
struct Load {
  double processor_s = 0.0;
  double wakes = 0.0;
};

std::int64_t cpu_ns(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// One window: how the servo thread kept time, and what the whole process used per second.
struct Window {
  runtime::ServoReport report;
  Load used;
};

/// Steps `step` for a window on a servo thread, with a tap each second.
template <class Step, class Tap>
Window window(const Options& options, const live::Engine& engine, Step step, const Tap& tap) {
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const std::int64_t cpu_before_ns = cpu_ns(CLOCK_PROCESS_CPUTIME_ID);
  auto servo = demand(
      runtime::ServoThread<Step>::start({.rate_Hz = 1.0 / engine.tick_s(), .core = options.core}, std::move(step)));
  for (double left_s = options.seconds; left_s > 0.0; left_s -= 1.0) {
    tap();
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(1.0, left_s)));
  }
  servo->stop();
  const auto& report = servo->finish();
  getrusage(RUSAGE_SELF, &after);
  return {.report = report,
          .used = {.processor_s =
                       1e-9 * static_cast<double>(cpu_ns(CLOCK_PROCESS_CPUTIME_ID) - cpu_before_ns) / options.seconds,
                   .wakes = static_cast<double>(after.ru_nvcsw - before.ru_nvcsw) / options.seconds}};
}

/// Threads that wake as often as the observers and use as much processor time, and touch no memory.
class BusyThreads {
 public:
  explicit BusyThreads(const Load& load) {
    if (load.wakes < 1.0 || load.processor_s <= 0.0) return;
    const std::chrono::duration<double> period(static_cast<double>(threads_.size()) / load.wakes);
    const double burn_ns = 1e9 * load.processor_s / load.wakes;
    for (std::thread& thread : threads_) thread = std::thread([this, period, burn_ns] { run(period, burn_ns); });
  }
  BusyThreads(const BusyThreads&) = delete;
  BusyThreads& operator=(const BusyThreads&) = delete;
  ~BusyThreads() {
    stop_ = true;
    for (std::thread& thread : threads_) {
      if (thread.joinable()) thread.join();
    }
  }

 private:
  void run(std::chrono::duration<double> period, double burn_ns) {
    // Of the thread's own processor time, so that waking counts too and no burn follows a late one.
    for (double due_ns = burn_ns; !stop_; due_ns += burn_ns) {
      while (static_cast<double>(cpu_ns(CLOCK_THREAD_CPUTIME_ID)) < due_ns) {
      }
      std::this_thread::sleep_for(period - std::chrono::duration<double>(1e-9 * burn_ns));
    }
  }
  std::atomic<bool> stop_{false};
  std::array<std::thread, 4> threads_;
};

Window unobserved(const Options& options, const Load& beside) {
  const auto view = make_view(options);
  live::Engine& engine = view->engine();
  const BusyThreads busy(beside);
  return window(
      options, engine,
      [&engine](const station::Tick&) noexcept {
        engine.step();
        return true;
      },
      [&view] { view->receive(1, "/operator/command", "json", R"({"command":"tap"})"); });
}

/// Who watches in a window.
struct Observers {
  bool log = false, page = false, ros2 = false;
};

Window observed(const Options& options, const Observers& who, Seen& seen) {
  const auto file = std::filesystem::temp_directory_path() / ("bench_observers_" + std::to_string(getpid()) + ".mcap");
  const auto view = make_view(options);
  live::Engine& engine = view->engine();
  std::optional<telemetry::Recorder> log;
  if (who.log) {
    log.emplace(demand(telemetry::Recorder::create(file)));
    engine.log_to(*log);
    log->start();
  }
  std::optional<ros2::Bridge> bridge;
  if (who.ros2)
    bridge.emplace(demand(ros2::Bridge::create({.network = demand(ros2::network_of(ros2::environment()))})));
  std::optional<live::Server> server;
  std::optional<Watcher> watcher;
  if (who.page) {
    server.emplace(demand(live::Server::start({.port = 0, .conversation = {}}, {}, *view)));
    watcher.emplace(server->port());
  }
  Window result = window(
      options, engine,
      [&engine, bridge = bridge ? &*bridge : nullptr](const station::Tick& tick) noexcept {
        engine.step();
        if (bridge != nullptr) {
          bridge->publish(ros2::snapshot_of(engine.newest(0), tick.deadline_ns, ros2::OperatingState::enabled));
          static_cast<void>(bridge->take_request());
        }
        return true;
      },
      [&] {
        if (watcher) {
          watcher->tap();
        } else {
          view->receive(1, "/operator/command", "json", R"({"command":"tap"})");
        }
      });
  Seen now;
  if (watcher) {
    now.live_dropped = server->counts().dropped + view->lost_ticks();
    server.reset();
    watcher->join();
    now.shown = watcher->messages();
  }
  if (bridge) {
    bridge->close();
    now.published = bridge->counts().published;
    now.ros2_dropped = bridge->counts().dropped;
  }
  if (log) {
    if (const auto error = log->stop()) give_up(describe(*error));
    now.logged = log->log().acknowledged();
    for (const std::uint64_t dropped : log->dropped()) now.log_dropped += dropped;
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
  }
  seen.add(now);
  return result;
}

/// One column of the comparison.
struct Condition {
  const char* name;
  Observers who = {};
  bool beside_load = false;
  std::vector<Window> windows = {};
  Seen seen = {};
};

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
    else if (name == "--each")
      options.each = std::atoi(words[i + 1]) != 0;
    else if (name == "--experiment")
      options.experiment = words[i + 1];
    else
      give_up("unknown option " + name + ": choose among --windows, --seconds, --core, --each, --experiment");
  }
  if (count % 2 == 0) give_up("each option has one value");
  return options;
}

/// The quantile of each window, in us.
std::vector<double> quantiles(const Condition& condition, runtime::DurationHistogram runtime::ServoReport::*histogram,
                              double q) {
  std::vector<double> values;
  for (const Window& one : condition.windows) values.push_back(1e-3 * (one.report.*histogram).quantile_ns(q));
  return values;
}

void print(const Options& options, const std::vector<Condition>& conditions) {
  const Condition &off = conditions[0], &on = conditions[1], &load = conditions[2];
  std::printf("Two loops on one servo thread; medians of %d windows of %g s each, core %d\n", options.windows,
              options.seconds, static_cast<int>(options.core));
  std::printf("%-16s", "us");
  for (const Condition& condition : conditions) std::printf("%10s", condition.name);
  std::printf("%10s%22s%10s   goal\n", "on/off", "each window", "load/off");
  const auto row = [&](const char* name, auto histogram, double q) {
    std::printf("%-16s", name);
    for (const Condition& condition : conditions) std::printf("%10.2f", median(quantiles(condition, histogram, q)));
    const std::vector<double> with = quantiles(on, histogram, q), without = quantiles(off, histogram, q);
    std::vector<double> ratios;
    for (std::size_t i = 0; i < with.size(); ++i) ratios.push_back(with[i] / without[i]);
    const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
    const double ratio = median(with) / median(without);
    std::printf("%10.3f%13.3f to %5.3f%10.3f   <= 1.05: %s\n", ratio, *least, *most,
                median(quantiles(load, histogram, q)) / median(without), ratio <= 1.05 ? "reached" : "missed");
  };
  row("step, p50", &runtime::ServoReport::duration, 0.5);
  row("step, p99", &runtime::ServoReport::duration, 0.99);
  row("lateness, p50", &runtime::ServoReport::lateness, 0.5);
  row("lateness, p99", &runtime::ServoReport::lateness, 0.99);
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  for (const Condition& condition : conditions) {
    runtime::ServoReport all;
    std::vector<double> processor_s, wakes;
    for (const Window& one : condition.windows) {
      all.add(one.report);
      processor_s.push_back(one.used.processor_s);
      wakes.push_back(one.used.wakes);
    }
    std::printf(
        "%-8s %4.1f %% of a core, %6.0f waits a second; late ticks: %lld of ours, %lld of the machine's, of %lld\n",
        condition.name, 100.0 * median(processor_s), median(wakes), static_cast<long long>(all.late_ours()),
        static_cast<long long>(all.late_machine()), static_cast<long long>(all.ticks));
    const Seen& seen = condition.seen;
    if (condition.who.log)
      std::printf("         log %llu records (%llu dropped)\n", number(seen.logged), number(seen.log_dropped));
    if (condition.who.page) {
      std::printf("         live client %llu messages (%llu dropped)\n", number(seen.shown), number(seen.live_dropped));
    }
    if (condition.who.ros2) {
      std::printf("         ROS 2 %llu snapshots (%llu dropped)\n", number(seen.published), number(seen.ros2_dropped));
    }
  }
  for (const auto& right : on.windows.front().report.rights) {
    if (!right.held) std::printf("not granted: %s\n", right.what.c_str());
  }
}

}  // namespace

int main(int count, char** words) {
  const Options options = read_options(count, words);
  std::vector<Condition> conditions{{.name = "all off"},
                                    {.name = "all on", .who = {.log = true, .page = true, .ros2 = true}},
                                    {.name = "load", .beside_load = true}};
  if (options.each) {
    conditions.push_back({.name = "log", .who = {.log = true}});
    conditions.push_back({.name = "page", .who = {.page = true}});
    conditions.push_back({.name = "ROS 2", .who = {.ros2 = true}});
  }
  const Condition &off = conditions[0], &on = conditions[1];
  // The load is that of the windows before, so one pair comes first that does not count.
  Seen uncounted;
  Load off_used = unobserved(options, {}).used, on_used = observed(options, on.who, uncounted).used;
  for (int i = 0; i < options.windows; ++i) {
    for (std::size_t k = 0; k < conditions.size(); ++k) {
      // Which comes first changes too.
      Condition& condition = conditions[(k + static_cast<std::size_t>(i)) % conditions.size()];
      if (condition.beside_load) {
        condition.windows.push_back(unobserved(options, {.processor_s = on_used.processor_s - off_used.processor_s,
                                                         .wakes = on_used.wakes - off_used.wakes}));
      } else {
        condition.windows.push_back(observed(options, condition.who, condition.seen));
      }
    }
    off_used = off.windows.back().used;
    on_used = on.windows.back().used;
  }
  print(options, conditions);
  return 0;
}
