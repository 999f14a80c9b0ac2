#include <tactus/cli/internal/json_text.hpp>
#include <tactus/cli/ros2_session.hpp>
#include <tactus/cli/run_log.hpp>
#include <tactus/configuration/toml_writer.hpp>
#include <tactus/experiments/presentation.hpp>
#include <tactus/report/files.hpp>
#include <tactus/report/page.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>
#include <tactus/ros2/bridge.hpp>
#include <tactus/ros2/remote_path.hpp>
#include <tactus/runtime/servo_presentation.hpp>
#include <tactus/telemetry/recorder.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using simulation::Teleoperator;
using Record = Teleoperator::Record;

constexpr double rest_before_s = 0.3;
constexpr double workspace_m = 1.0;

/// What steps, all of it made before the first tick.
struct Parts {
  Teleoperator teleoperator;
  ros2::RemotePath path;
  TapScript script;
  double slave_workspace_m;
};

Result<Parts> make_parts(const experiments::TappingParams& params) {
  // The whole experiment is checked, as without ROS 2.
  if (const auto ensemble = experiments::TappingEnsemble::make(params); !ensemble) return ensemble.error();
  TapScript script(params);
  auto teleoperator = Teleoperator::make(params, script.position_m(0.0));
  if (!teleoperator) return teleoperator.error();
  auto path = ros2::RemotePath::make({}, Seconds{teleoperator->tick_s()});
  if (!path) return path.error();
  return Parts{*std::move(teleoperator), *path, std::move(script), workspace_m * params.control.position_scale};
}

using RecordStream = telemetry::RecordStream<Record>;

/// What a servo thread steps, and what it saw. `Parts` and the rest outlive it.
struct Session {
  Parts* parts;
  ros2::Bridge* bridge;
  RecordStream* log;        ///< or null
  std::int64_t to_wall_ns;  ///< from CLOCK_MONOTONIC to the time of day
  const runtime::EndRequest* end;
  std::int64_t first_tick = -1;
  std::int64_t done = 0;  ///< ticks
  double path_m = 0.0;
  int contacts = 0;
  double peak_force_N = 0.0;
  bool diverged = false;
  double letting_go_s = 0.0;

  [[nodiscard]] double time_s() const noexcept { return static_cast<double>(done) * parts->teleoperator.tick_s(); }

  bool operator()(const station::Tick& tick) noexcept {
    if (end->insisted()) return false;
    if (first_tick < 0) {
      first_tick = tick.number;
      path_m = parts->script.position_m(0.0);
    }
    while (done <= tick.number - first_tick) {
      const bool over = time_s() >= parts->script.duration_s() || end->asked() || diverged;
      advance(tick.deadline_ns + to_wall_ns, over ? 0.0 : 1.0);
      if (!over) continue;
      letting_go_s += parts->teleoperator.tick_s();
      if (parts->teleoperator.at_rest() || letting_go_s >= runtime::longest_ramp_s) return false;
    }
    return true;
  }

 private:
  /// One tick; `share` as in `Teleoperator::step`.
  void advance(std::int64_t stamp_ns, double share) noexcept {
    Teleoperator& teleoperator = parts->teleoperator;
    const auto since_start_ns = static_cast<std::uint64_t>(std::llround(1e9 * time_s()));
    ++done;
    const double next_m =
        parts->path.step({.scripted_m = parts->script.position_m(time_s()), .wished_m = bridge->take_wish()});
    const Record record = teleoperator.step(path_m, next_m, share);
    path_m = next_m;
    bridge->publish(snapshot_of(record, stamp_ns, teleoperator.healthy()));
    if (log != nullptr) log->push(since_start_ns, record);
    contacts += record.touched ? 1 : 0;
    peak_force_N = std::max(peak_force_N, record.peak_contact_force_N);
    // Written so that a NaN counts as outside.
    const bool inside = std::fabs(record.master_position_m) < workspace_m &&
                        std::fabs(record.tip_position_m) < parts->slave_workspace_m;
    diverged = diverged || !inside || !teleoperator.healthy();
  }
};

std::string json_of(const experiments::Request& request, const Ros2Options& options, const Session& session,
                    const ros2::Bridge::Counts& counts, const runtime::ServoReport& servo) {
  return json_text({{"experiment", request.name},
                    {"command", request.command},
                    {"namespace", options.name_space},
                    {"time_s", session.time_s()},
                    {"contacts", session.contacts},
                    {"peak_contact_force_N", session.peak_force_N},
                    {"driven", session.parts->path.driven()},
                    {"published", counts.published},
                    {"dropped", counts.dropped},
                    {"messages_lost", counts.lost},
                    {"wishes", counts.wishes},
                    {"commands_refused", counts.refused},
                    {"servo", nlohmann::ordered_json::parse(runtime::servo_json(servo))}});
}

report::Table table_of(const Ros2Options& options, const Session& session, const ros2::Bridge::Counts& counts) {
  report::Table table({{.title = "quantity", .align = report::Column::Align::left}, {.title = "value"}},
                      "Among ROS 2 nodes, namespace " + options.name_space);
  const auto count = [](std::uint64_t value) { return std::to_string(value); };
  table.add_row({"time", report::number(session.time_s(), 4) + " s"});
  table.add_row({"contacts", std::to_string(session.contacts)});
  table.add_row({"largest contact force", report::number(session.peak_force_N, 3) + " N"});
  table.add_row({"snapshots published", count(counts.published)});
  table.add_row({"snapshots dropped", count(counts.dropped)});
  table.add_row({"messages lost", count(counts.lost)});
  table.add_row({"wishes for the hand", count(counts.wishes)});
  table.add_row({"commands refused", count(counts.refused)});
  return table;
}

experiments::Outcome outcome_of(const experiments::Request& request, const Ros2Options& options, const Session& session,
                                const ros2::Bridge::Counts& counts, const runtime::ServoReport& servo,
                                const std::string& configuration) {
  const report::Table table = table_of(options, session, counts);
  const report::Figure figure = runtime::timing_figure(servo);
  report::Page page(request.name + " among ROS 2 nodes");
  page.paragraph("The teleoperator ran in real time and published under the namespace " + options.name_space + ".");
  page.table(table);
  runtime::add_timing(page, servo, figure);
  experiments::add_provenance(page, request, configuration);
  return {.text = table.to_text() + "\n" + runtime::timing_text(servo),
          .json = json_of(request, options, session, counts, servo),
          .html = page.to_html(),
          .figures = {figure}};
}

}  // namespace

ros2::Snapshot snapshot_of(const Teleoperator::Record& record, std::int64_t stamp_ns, bool healthy) {
  return {.stamp_ns = stamp_ns,
          .master_position_m = record.master_position_m,
          .master_force_N = -record.displayed_force_N,
          .hand_force_N = record.hand_force_N,
          .slave_position_m = record.slave_position_m,
          .slave_command_m = record.command_m,
          .environment_force_N = record.told_force_N,
          .healthy = healthy};
}

TapScript::TapScript(const experiments::TappingParams& params) {
  const experiments::TappingTask& task = params.task;
  const double depth_m = 0.5 * (task.shallowest_m + task.deepest_m);
  const double wall_m = params.environment.position_m / params.control.position_scale;
  for (std::int64_t i = 0; i < task.taps; ++i) {
    const double share = task.taps == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(task.taps - 1);
    const double speed = task.slowest_m_per_s + share * (task.fastest_m_per_s - task.slowest_m_per_s);
    const double reach_s = mechanics::MinimumJerk::duration_for(2.0 * depth_m, speed);
    const double reaches_s = duration_s_ + rest_before_s;
    const double returns_s = reaches_s + reach_s + task.observation_s;
    taps_.push_back({.reach = {wall_m - depth_m, wall_m + depth_m, reaches_s, reach_s},
                     .back = {wall_m + depth_m, wall_m - depth_m, returns_s, reach_s}});
    duration_s_ = returns_s + reach_s;
  }
}

double TapScript::position_m(double time_s) const {
  const auto later = std::upper_bound(taps_.begin(), taps_.end(), time_s, [](double time, const Tap& tap) {
    return time < tap.reach.start_time_s - rest_before_s;
  });
  const Tap& tap = later == taps_.begin() ? taps_.front() : *std::prev(later);
  return time_s < tap.back.start_time_s ? tap.reach.position_m(time_s) : tap.back.position_m(time_s);
}

Result<experiments::Outcome> run_ros2_session(const experiments::Request& request, const Ros2Options& options,
                                              OutputFolder& output) {
  const auto params = request.document.read<experiments::TappingParams>();
  if (!params) return params.error();
  auto parts = make_parts(*params);
  if (!parts) return request.document.locate(parts.error());

  const auto network = ros2::network_of(ros2::environment());
  if (!network) return network.error();
  auto bridge = ros2::Bridge::create({.network = *network, .name_space = options.name_space});
  if (!bridge) return bridge.error();

  std::optional<telemetry::Recorder> recorder;
  RecordStream* stream = nullptr;
  const std::filesystem::path log_file = output.log_folder() / "log.mcap";
  if (output.wanted()) {
    if (auto error = output.begin()) return *std::move(error);
    if (auto error = report::prepare_directory(output.log_folder())) return *std::move(error);
    auto opened = telemetry::Recorder::create(log_file, options.log_limit_bytes);
    if (!opened) return opened.error();
    recorder.emplace(*std::move(opened));
    auto about = log_origin();
    about["experiment"] = request.name;
    about["configuration"] = configuration::to_toml(*params);
    about["clock"] = "real";
    recorder->add_metadata("tactus", about);
    stream = &recorder->add<Record>("/teleoperator", "tactus_msgs/msg/TeleoperatorRecord");
  }
  runtime::ServoThreadParams servo = options.servo;
  servo.rate_Hz = params->servo.rate_Hz;
  if (recorder) recorder->start();
  const std::int64_t wall_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  Session session{.parts = &*parts,
                  .bridge = &*bridge,
                  .log = stream,
                  .to_wall_ns = wall_ns - runtime::monotonic_ns(),
                  .end = &options.end};
  const auto report = runtime::run_servo(servo, [&](const station::Tick& tick) noexcept { return session(tick); });
  bridge->close();
  if (recorder) {
    if (auto error = recorder->stop()) return *std::move(error);
    if (auto error = telemetry::write_bag_metadata(log_file, recorder->log())) {
      return *std::move(error);
    }
  }
  if (!report) return report.error();
  if (session.diverged) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "after " + report::number(session.time_s(), 4) +
                            " s a safety gate has closed or a device has left its workspace of 1 m: lower "
                            "control.force_gain, or switch cancellation on",
                 .place = {}};
  }
  return outcome_of(request, options, session, bridge->counts(), *report, configuration::to_toml(*params));
}

}  // namespace tactus::cli
