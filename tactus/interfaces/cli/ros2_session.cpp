// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/report/files.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/data/telemetry/recorder.hpp>
#include <tactus/interfaces/cli/observers.hpp>
#include <tactus/interfaces/cli/ros2_session.hpp>
#include <tactus/interfaces/cli/run_log.hpp>
#include <tactus/runtime/ros2/bridge.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/real_time/hand_session.hpp>

#include <iostream>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using real_time::HandSession;

std::string json_of(const experiments::Request& request, const Ros2Options& options, const HandSession& session,
                    const ros2::Bridge::Counts& counts, const runtime::ServoReport& servo) {
  return report::json_text(
      nlohmann::ordered_json{{"experiment", request.name},
                             {"namespace", options.name_space},
                             {"time_s", session.time_s()},
                             {"contacts", session.contacts()},
                             {"peak_contact_force_N", session.peak_force_N()},
                             {"driven", session.driven()},
                             {"published", counts.published},
                             {"dropped", counts.dropped},
                             {"messages_lost", counts.lost},
                             {"requests", counts.requests},
                             {"commands_refused", counts.refused},
                             {"servo", report::parse_json<nlohmann::ordered_json>(runtime::servo_json(servo))}});
}

report::Table table_of(const Ros2Options& options, const HandSession& session, const ros2::Bridge::Counts& counts) {
  report::Table table({{.title = "quantity", .align = report::Column::Align::left}, {.title = "value"}},
                      "Among ROS 2 nodes, namespace " + options.name_space);
  const auto count = [](std::uint64_t value) { return std::to_string(value); };
  table.add_row({"time", report::number(session.time_s(), 4) + " s"});
  table.add_row({"contacts", std::to_string(session.contacts())});
  table.add_row({"largest contact force", report::number(session.peak_force_N(), 3) + " N"});
  table.add_row({"snapshots published", count(counts.published)});
  table.add_row({"snapshots dropped", count(counts.dropped)});
  table.add_row({"messages lost", count(counts.lost)});
  table.add_row({"requests for the hand", count(counts.requests)});
  table.add_row({"commands refused", count(counts.refused)});
  return table;
}

experiments::Outcome outcome_of(const experiments::Request& request, const Ros2Options& options,
                                const HandSession& session, const ros2::Bridge::Counts& counts,
                                const runtime::ServoReport& servo, const std::string& configuration) {
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
          .figures = {figure},
          .traces = {},
          .configuration = configuration};
}

}  // namespace

Result<experiments::Outcome> run_ros2_session(const experiments::Request& request, const Ros2Options& options,
                                              OutputFolder& output) {
  const auto params = request.document.read<experiments::TappingParams>();
  if (!params) return params.error();
  auto session = HandSession::make(*params);
  if (!session) return request.document.locate(session.error());

  const auto network = ros2::network_of(ros2::environment());
  if (!network) return network.error();
  auto bridge = ros2::Bridge::create({.network = *network, .name_space = options.name_space});
  if (!bridge) return bridge.error();

  std::optional<telemetry::Recorder> recorder;
  runtime::RealTimeStreams::Teleoperator stream;
  runtime::RealTimeStreams streams;
  auto observers = Observers::open({.live = options.live}, request);
  if (!observers) return observers.error();
  if (output.wanted() || observers->any()) streams.teleoperator = &stream;
  observers->watch(streams);
  const auto say = [&output](const std::string& line) {
    if (!line.empty()) (output.json() ? std::cerr : std::cout) << line << std::flush;
  };
  if (auto error = observers->begin(say)) return *std::move(error);
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
    streams.for_each([&recorder](const std::string& topic, const char* type_name, const auto& each) {
      recorder->add(topic, type_name, each);
    });
  }
  runtime::ServoThreadParams servo = options.servo;
  servo.rate_Hz = params->servo.rate_Hz;
  if (recorder) recorder->start();
  session->begin(*bridge, streams, options.end);
  const auto report = runtime::run_servo(servo, [&](const station::Tick& tick) noexcept { return (*session)(tick); });
  bridge->close();
  say(observers->end());
  if (recorder) {
    if (auto error = recorder->stop()) return *std::move(error);
    if (auto error = telemetry::write_bag_metadata(log_file, recorder->log())) {
      return *std::move(error);
    }
  }
  if (!report) return report.error();
  if (session->diverged()) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "after " + report::number(session->time_s(), 4) +
                            " s a safety gate has closed or a device has left its workspace of 1 m: lower "
                            "control.force_gain, or switch cancellation on",
                 .place = {}};
  }
  return outcome_of(request, options, *session, bridge->counts(), *report, configuration::to_toml(*params));
}

}  // namespace tactus::cli
