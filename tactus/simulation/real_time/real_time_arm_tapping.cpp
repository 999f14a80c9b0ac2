// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/urdf/described_arms.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>
#include <tactus/runtime/servo/site_log.hpp>
#include <tactus/runtime/servo/site_parts.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_tap_run.hpp>
#include <tactus/simulation/experiments/arm_tapping/presentation.hpp>
#include <tactus/simulation/real_time/internal/real_time_run.hpp>
#include <tactus/simulation/real_time/real_time_arm_tap.hpp>

#include <utility>

namespace tactus::real_time {

namespace {

using experiments::ArmTapResult;
using experiments::ArmTaps;

Check refuse_what_arms_lack(const experiments::Request& request, const RealTimeOptions& options) {
  const auto refused = [](const char* option, std::string message) {
    return Error{.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = option};
  };
  if (options.plant) {
    return refused("--plant",
                   "a plant has devices of one axis, and these are arms: leave it out, and they are "
                   "simulated in this program");
  }
  if (!request.variations.empty()) {
    return refused("--vary",
                   "arms in real time run one combination: write --set in its place, or vary in virtual time");
  }
  return std::nullopt;
}

/// Opens the log of what goes into the streams from now on.
Result<runtime::SiteLog> open_arm_log(const experiments::Request& request, const RealTimeOptions& options,
                                      const ArmTapStreams& streams, const std::string& configuration,
                                      const experiments::ArmPairSetup& setup) {
  if (options.before_log) {
    if (auto error = options.before_log()) return *std::move(error);
  }
  runtime::LogMetadata about{{"tactus", options.about}};
  about["tactus"]["experiment"] = request.name;
  about["tactus"]["configuration"] = configuration;
  about["tactus"]["clock"] = "real";
  for (const std::string& joint : setup.leader.joints) {
    about["tactus"]["joints"] += (joint == setup.leader.joints.front() ? "" : ",") + joint;
  }
  about["urdf"] = runtime::urdfs_of(setup);
  return runtime::SiteLog::create(options.log->parent_path(), streams, about, options.log_limit_bytes);
}

/// The taps that came to their end.
struct ArmTapsDone {
  std::vector<ArmTapResult> results;
  experiments::ArmTrace first;
  runtime::ServoReport servo;
};

Result<ArmTapsDone> run_arm_taps(const ArmTaps& taps, const runtime::ServoThreadParams& servo, ArmTapStreams* streams,
                                 const runtime::EndRequest& end, const experiments::Progress& progress) {
  ArmTapsDone done;
  for (std::size_t tap = 0; tap < taps.size() && !end.asked(); ++tap) {
    const experiments::ArmContact without_display = taps.run_without_display(tap);
    auto run = RealTimeArmTap::make(taps.setup(), taps.tap(tap), streams);
    if (!run) return run.error();
    const auto report =
        runtime::run_servo(servo, [&](const station::Tick& tick) noexcept { return !end.asked() && run->step(tick); });
    if (!report) return report.error();
    done.servo.add(*report);
    if (end.asked()) break;  // this one may have been cut short
    const experiments::ArmTapRun& ran = run->run();
    if (tap == 0) done.first = ran.trace();
    done.results.push_back(experiments::judge_arm_tap(ran.contact(), ran.diverged(), without_display));
    progress(static_cast<double>(done.results.size()) / static_cast<double>(taps.size()));
  }
  return done;
}

}  // namespace

Result<RealTimeOutcome> run_arms_in_real_time(const experiments::Request& request, const RealTimeOptions& options,
                                              const experiments::Progress& progress) {
  if (auto error = refuse_what_arms_lack(request, options)) return *std::move(error);
  const std::filesystem::path folder = std::filesystem::path(request.document.name()).parent_path();
  runtime::ServoThreadParams servo = options.servo;
  const auto cases = experiments::prepare_cases<experiments::ArmTappingParams, ArmTaps>(
      request, [&](const experiments::ArmTappingParams& params) -> Result<ArmTaps> {
        servo.rate_Hz = params.servo.rate_Hz;
        if (auto error = check_servo_thread(servo)) return *std::move(error);
        if (auto error = station::refuse_tool_coupling(params, "run --realtime")) return *std::move(error);
        return ArmTaps::make(params, folder);
      });
  if (!cases) return cases.error();
  const auto& [settings, taps] = cases->all.front();
  if (auto error = refuse_many_taps(taps.size())) return request.document.locate(*std::move(error));

  const std::vector<std::string>& joints = taps.setup().leader.joints;
  std::optional<ArmTapStreams> streams;
  if (options.log || options.look_on_arms) streams.emplace(joints.size());
  if (options.look_on_arms) {
    if (auto error = options.look_on_arms(*streams, joints)) return *std::move(error);
  }
  std::optional<runtime::SiteLog> log;
  if (options.log) {
    auto opened = open_arm_log(request, options, *streams, cases->first_configuration, taps.setup());
    if (!opened) return opened.error();
    log.emplace(*std::move(opened));
  }
  const runtime::ProcessRights process;  // once for all taps
  const runtime::EndRequest never;
  auto done =
      run_arm_taps(taps, servo, streams ? &*streams : nullptr, options.end != nullptr ? *options.end : never, progress);
  KeptTime kept;
  if (log) kept.log = log->close();
  if (!done) return done.error();
  kept.all = done->servo;
  if (done->results.size() < taps.size()) kept.interrupted = Interrupted{done->results.size(), taps.size()};

  std::vector<experiments::ArmTappingRun> runs;
  std::vector<report::Figure> figures;
  if (!done->results.empty()) {
    std::vector<experiments::ArmHold> holds;
    for (std::size_t i = 0; i < taps.holds(); ++i) holds.push_back(taps.hold(i));
    runs.push_back({settings, experiments::summarise(done->results, taps.reach(), holds)});
    kept.runs.push_back(done->servo);
    figures = experiments::arm_figures(settings, taps, done->first);
  }
  figures.push_back(timing_figure(kept.all));
  const report::Table table = experiments::arm_table(runs);
  const std::string verdict = experiments::arm_verdict(runs);
  report::Page page = experiments::arm_page(request, verdict, table, figures);
  page.paragraph(
      "The taps at gain 0, with which a runaway is compared, and the reach that shows the lag were run in virtual "
      "time.");
  return real_time_outcome(request, cases->first_configuration, options.plant,
                           {.verdict = verdict,
                            .table = table,
                            .json = experiments::arm_json(request, runs),
                            .page = std::move(page),
                            .figures = std::move(figures)},
                           std::move(kept));
}

}  // namespace tactus::real_time
