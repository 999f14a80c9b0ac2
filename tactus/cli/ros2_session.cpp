#include <tactus/cli/ros2_session.hpp>
#include <tactus/cli/run_log.hpp>
#include <tactus/configuration/toml_writer.hpp>
#include <tactus/report/files.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>
#include <tactus/ros2/bridge.hpp>
#include <tactus/ros2/remote_path.hpp>
#include <tactus/telemetry/recorder.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using simulation::Teleoperator;
using Clock = std::chrono::steady_clock;
using Record = Teleoperator::Record;

constexpr double rest_s = 0.3;
constexpr double workspace_m = 1.0;
/// Beyond this the session gives up on the time that it has lost instead of making up for it.
constexpr std::chrono::milliseconds longest_lag{100};

volatile std::sig_atomic_t interrupted = 0;

/// Ctrl-C ends the session and not the program.
class Interruptible {
 public:
  Interruptible() : before_{std::signal(SIGINT, &note), std::signal(SIGTERM, &note)} { interrupted = 0; }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  ~Interruptible() {
    std::signal(SIGINT, before_[0]);
    std::signal(SIGTERM, before_[1]);
  }

 private:
  static void note(int) { interrupted = 1; }
  void (*before_[2])(int);
};

struct Session {
  double time_s = 0.0;
  double worst_lag_s = 0.0;
  int contacts = 0;
  double peak_force_N = 0.0;
  bool driven = false;
  bool diverged = false;
  ros2::Bridge::Counts counts;
};

ros2::Snapshot snapshot_of(const Record& record, std::int64_t stamp_ns, bool healthy) {
  return {.stamp_ns = stamp_ns,
          .master_position_m = record.master_position_m,
          .master_force_N = -record.displayed_force_N,
          .hand_force_N = record.hand_force_N,
          .slave_position_m = record.slave_position_m,
          .slave_command_m = record.command_m,
          .environment_force_N = record.told_force_N,
          .healthy = healthy};
}

/// What steps, all of it made before the first tick.
struct Parts {
  Teleoperator teleoperator;
  ros2::RemotePath path;
  TapScript script;
  double slave_workspace_m;
};

Result<Parts> make_parts(const simulation::TappingParams& params) {
  // The whole experiment is checked, as without ROS 2.
  if (const auto ensemble = simulation::TappingEnsemble::make(params); !ensemble) return ensemble.error();
  TapScript script(params);
  auto teleoperator = Teleoperator::make(params, script.position_m(0.0));
  if (!teleoperator) return teleoperator.error();
  auto path = ros2::RemotePath::make({}, Seconds{teleoperator->tick_s()});
  if (!path) return path.error();
  return Parts{*std::move(teleoperator), *path, std::move(script), workspace_m * params.control.position_scale};
}

using RecordStream = telemetry::RecordStream<Record>;

Session run(Parts& parts, ros2::Bridge& bridge, RecordStream* log) {
  const Interruptible interruptible;
  const std::int64_t tick_ns = std::llround(1e9 * parts.teleoperator.tick_s());
  const auto ticks = static_cast<std::int64_t>(parts.script.duration_s() / parts.teleoperator.tick_s());
  Session session;
  Clock::time_point start = Clock::now();
  std::int64_t stamp_ns = std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  double path_m = parts.script.position_m(0.0);
  for (std::int64_t tick = 0; tick < ticks && interrupted == 0; ++tick) {
    const Clock::time_point due = start + std::chrono::nanoseconds(tick * tick_ns);
    std::this_thread::sleep_until(due);
    const auto lag = Clock::now() - due;
    session.worst_lag_s = std::max(session.worst_lag_s, std::chrono::duration<double>(lag).count());
    if (lag > longest_lag) {
      start += lag;
      stamp_ns += std::chrono::nanoseconds(lag).count();
    }

    session.time_s = static_cast<double>(tick + 1) * parts.teleoperator.tick_s();
    const double next_m =
        parts.path.step({.scripted_m = parts.script.position_m(session.time_s), .wished_m = bridge.take_wish()});
    const Record record = parts.teleoperator.step(path_m, next_m);
    path_m = next_m;
    const bool healthy = parts.teleoperator.healthy();
    bridge.publish(snapshot_of(record, stamp_ns + tick * tick_ns, healthy));
    if (log != nullptr) log->push(static_cast<std::uint64_t>(tick * tick_ns), record);

    session.contacts += record.touched ? 1 : 0;
    session.peak_force_N = std::max(session.peak_force_N, record.peak_contact_force_N);
    // Written so that a NaN counts as outside.
    const bool inside =
        std::fabs(record.master_position_m) < workspace_m && std::fabs(record.tip_position_m) < parts.slave_workspace_m;
    if (!inside || !healthy) {
      session.diverged = true;
      break;
    }
  }
  session.driven = parts.path.driven();
  bridge.close();
  session.counts = bridge.counts();
  return session;
}

std::string json_of(const simulation::Request& request, const Ros2Options& options, const Session& session) {
  return nlohmann::ordered_json{{"experiment", request.name},
                                {"command", request.command},
                                {"namespace", options.name_space},
                                {"time_s", session.time_s},
                                {"worst_lag_s", session.worst_lag_s},
                                {"contacts", session.contacts},
                                {"peak_contact_force_N", session.peak_force_N},
                                {"driven", session.driven},
                                {"published", session.counts.published},
                                {"dropped", session.counts.dropped},
                                {"messages_lost", session.counts.lost},
                                {"wishes", session.counts.wishes},
                                {"commands_refused", session.counts.refused}}
             .dump(2) +
         "\n";
}

std::string text_of(const Ros2Options& options, const Session& session) {
  report::Table table({{.title = "quantity", .align = report::Column::Align::left}, {.title = "value"}},
                      "Among ROS 2 nodes, namespace " + options.name_space);
  const auto count = [](std::uint64_t value) { return std::to_string(value); };
  table.add_row({"time", report::number(session.time_s, 4) + " s"});
  table.add_row({"largest lag behind real time", report::number(1e3 * session.worst_lag_s, 3) + " ms"});
  table.add_row({"contacts", std::to_string(session.contacts)});
  table.add_row({"largest contact force", report::number(session.peak_force_N, 3) + " N"});
  table.add_row({"snapshots published", count(session.counts.published)});
  table.add_row({"snapshots dropped", count(session.counts.dropped)});
  table.add_row({"messages lost", count(session.counts.lost)});
  table.add_row({"wishes for the hand", count(session.counts.wishes)});
  table.add_row({"commands refused", count(session.counts.refused)});
  return table.to_text();
}

}  // namespace

TapScript::TapScript(const simulation::TappingParams& params) {
  const simulation::TappingTask& task = params.task;
  const double depth_m = 0.5 * (task.shallowest_m + task.deepest_m);
  const double wall_m = params.environment.position_m / params.control.position_scale;
  for (std::int64_t i = 0; i < task.taps; ++i) {
    const double share = task.taps == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(task.taps - 1);
    const double speed = task.slowest_m_per_s + share * (task.fastest_m_per_s - task.slowest_m_per_s);
    const double reach_s = mechanics::MinimumJerk::duration_for(2.0 * depth_m, speed);
    const double reaches_s = duration_s_ + rest_s;
    const double returns_s = reaches_s + reach_s + task.observation_s;
    taps_.push_back({.reach = {wall_m - depth_m, wall_m + depth_m, reaches_s, reach_s},
                     .back = {wall_m + depth_m, wall_m - depth_m, returns_s, reach_s}});
    duration_s_ = returns_s + reach_s;
  }
}

double TapScript::position_m(double time_s) const {
  const auto later = std::upper_bound(taps_.begin(), taps_.end(), time_s, [](double time, const Tap& tap) {
    return time < tap.reach.start_time_s - rest_s;
  });
  const Tap& tap = later == taps_.begin() ? taps_.front() : *std::prev(later);
  return time_s < tap.back.start_time_s ? tap.reach.position_m(time_s) : tap.back.position_m(time_s);
}

Result<std::string> run_ros2_session(const simulation::Request& request, const Ros2Options& options, bool json) {
  const auto params = request.document.read<simulation::TappingParams>();
  if (!params) return params.error();
  auto parts = make_parts(*params);
  if (!parts) return request.document.locate(parts.error());

  const auto network = ros2::network_of(ros2::environment());
  if (!network) return network.error();
  auto bridge = ros2::Bridge::create({.network = *network, .name_space = options.name_space});
  if (!bridge) return bridge.error();

  std::optional<telemetry::Recorder> recorder;
  RecordStream* stream = nullptr;
  if (options.log_folder) {
    if (auto error = report::prepare_directory(*options.log_folder)) return *std::move(error);
    auto opened = telemetry::Recorder::create(*options.log_folder / log_file_name);
    if (!opened) return opened.error();
    recorder.emplace(*std::move(opened));
    recorder->add_metadata("tactus", about_run(request, configuration::to_toml(*params)));
    stream = &recorder->add<Record>(teleoperator_topic, teleoperator_type);
  }
  if (recorder) recorder->start();
  const Session session = run(*parts, *bridge, stream);
  if (recorder) {
    if (auto error = recorder->stop()) return *std::move(error);
    if (auto error = telemetry::write_bag_metadata(*options.log_folder / log_file_name, recorder->log())) {
      return *std::move(error);
    }
  }
  if (session.diverged) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "after " + report::number(session.time_s, 4) +
                            " s a safety gate has closed or a device has left its workspace of 1 m: lower "
                            "control.force_gain, or switch cancellation on",
                 .place = {}};
  }
  return json ? json_of(request, options, session) : text_of(options, session);
}

}  // namespace tactus::cli
