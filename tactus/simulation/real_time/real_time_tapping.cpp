// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>
#include <tactus/simulation/experiments/presentation.hpp>
#include <tactus/simulation/experiments/tapping/presentation.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/real_time/internal/real_time_run.hpp>
#include <tactus/simulation/real_time/real_time_tapping.hpp>
#include <tactus/simulation/real_time/shared_plant.hpp>

#include <cstddef>
#include <utility>
#include <vector>

namespace tactus::real_time {

namespace {

using experiments::TappingEnsemble;
using experiments::TappingParams;
using experiments::TappingRun;
using experiments::TapResult;

struct Prepared {
  TappingParams params;
  TappingEnsemble ensemble;
  double observation_s;
  runtime::ServoThreadParams servo;
};
using Cases = experiments::Cases<Prepared>;

Check refuse_long_runs(const Cases& cases) {
  std::size_t taps = 0;
  for (const auto& one : cases.all) taps += one.prepared.ensemble.size();
  if (auto error = refuse_many_taps(taps)) return error;
  if (cases.all.size() > most_real_time_runs) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = std::to_string(cases.all.size()) + " combinations in real time are more than " +
                            std::to_string(most_real_time_runs) + ": vary fewer values",
                 .place = "--vary"};
  }
  return std::nullopt;
}

/// The plant that all runs go through.
Result<std::unique_ptr<SharedPlant>> attach_plant(const PlantChoice& choice, const Cases& cases) {
  auto plant = SharedPlant::attach(choice.name, choice.silence);
  if (!plant) return plant.error();
  for (const auto& one : cases.all) {
    if (auto error = (*plant)->check(one.prepared.params)) return *std::move(error);
  }
  return plant;
}

/// Where the ticks of all runs go.
class Outlets {
 public:
  explicit Outlets(const Cases& cases) {
    for (std::size_t i = 0; i < cases.all.size(); ++i) {
      owned_.push_back(std::make_unique<Owned>());
      Owned& own = *owned_.back();
      all_.push_back({.teleoperator = &own.teleoperator,
                      .servo = &own.servo,
                      .sites = &own.sites,
                      .origin_ns = runtime::monotonic_ns(),
                      .prefix = cases.all.size() > 1 ? std::string("/").append(run_name(i)) : std::string()});
    }
  }
  [[nodiscard]] const std::vector<runtime::RealTimeStreams>& all() const { return all_; }
  static std::string run_name(std::size_t i) { return "run_" + std::to_string(i + 1); }

 private:
  struct Owned {
    runtime::RealTimeStreams::Teleoperator teleoperator;
    runtime::RealTimeStreams::Servo servo;
    runtime::RealTimeStreams::Sites sites;
  };
  std::vector<std::unique_ptr<Owned>> owned_;
  std::vector<runtime::RealTimeStreams> all_;
};

Result<telemetry::Recorder> open_log(const experiments::Request& request, const RealTimeOptions& options,
                                     const Cases& cases, const Outlets& outlets) {
  if (options.before_log) {
    if (auto error = options.before_log()) return *std::move(error);
  }
  if (auto error = report::prepare_directory(options.log->parent_path())) return *std::move(error);
  auto recorder = telemetry::Recorder::create(*options.log, options.log_limit_bytes);
  if (!recorder) return recorder.error();
  auto about = options.about;
  about["experiment"] = request.name;
  about["configuration"] = cases.first_configuration;
  about["clock"] = "real";
  recorder->add_metadata("tactus", about);
  std::map<std::string, std::string> labels;
  for (std::size_t i = 0; i < cases.all.size(); ++i) {
    const experiments::Settings& settings = cases.all[i].settings;
    if (!settings.empty()) {
      recorder->add_metadata(Outlets::run_name(i), {settings.begin(), settings.end()});
      labels[Outlets::run_name(i)] = experiments::settings_caption(settings);
    }
    outlets.all()[i].for_each([&recorder](const std::string& topic, const char* type_name, const auto& stream) {
      recorder->add(topic, type_name, stream);
    });
  }
  if (!labels.empty()) recorder->add_metadata(telemetry::run_labels, labels);
  recorder->start();
  return recorder;
}

Check close_log(telemetry::Recorder& recorder, const std::filesystem::path& file) {
  if (auto error = recorder.stop()) return error;
  return telemetry::write_bag_metadata(file, recorder.log());
}

/// Taps of a run whose every tick is kept in memory, one of them to be shown; the log has all.
constexpr std::size_t most_traces = 64;

/// One run as it went, and how time was kept in it.
struct RealTimeRun {
  std::optional<TappingRun> run;  ///< none where not even its first tap came to its end
  runtime::ServoReport servo;
};

/// Steps the tap to its end, or to the one that was asked for.
Result<runtime::ServoReport> run_tap(RealTimeTap& tap, const runtime::ServoThreadParams& servo,
                                     const runtime::EndRequest& end) {
  return runtime::run_servo(servo, [&tap, &end](const station::Tick& tick) noexcept {
    if (end.insisted()) {
      tap.release();
      return false;
    }
    if (end.asked()) tap.end();
    return tap.step(tick);
  });
}

/// With `plant` null, through devices of its own.
Result<RealTimeRun> run_taps(const experiments::Case<Prepared>& one, SharedPlant* plant,
                             runtime::RealTimeStreams streams, const runtime::EndRequest& end,
                             const std::function<void()>& tap_done) {
  const auto& [settings, prepared] = one;
  RealTimeRun done;
  std::vector<TapResult> results;
  std::vector<std::vector<simulation::Teleoperator::Record>> traces;
  for (std::size_t tap = 0; tap < prepared.ensemble.size() && !end.asked(); ++tap) {
    streams.tap = static_cast<std::int64_t>(tap);
    const experiments::Tap& drawn = prepared.ensemble.tap(tap);
    if (plant != nullptr) {
      if (auto error = plant->begin(tap)) return *std::move(error);
    }
    auto made = plant != nullptr ? RealTimeTap::make(drawn, prepared.observation_s, *plant, streams)
                                 : RealTimeTap::make(drawn, prepared.observation_s, streams);
    if (!made) return made.error();
    RealTimeTap& running = **made;
    const auto report = run_tap(running, prepared.servo, end);
    if (!report) return report.error();
    if (plant != nullptr) {
      if (plant->lost()) return plant->why_lost();
      plant->end();
    }
    done.servo.add(*report);
    if (end.asked()) break;  // this one may have been cut short
    results.push_back(running.result());
    if (traces.size() < most_traces) traces.push_back(running.trace());
    tap_done();
  }
  if (results.empty()) return done;
  const std::vector<TapResult> kept(results.begin(), results.begin() + static_cast<std::ptrdiff_t>(traces.size()));
  const std::size_t shown = experiments::median_tap(kept);
  done.run = TappingRun{.settings = settings,
                        .metrics = experiments::summarise(results),
                        .observation_s = prepared.observation_s,
                        .first_touch_s = results[shown].first_touch_s,
                        .trace = std::move(traces[shown])};
  return done;
}

Result<RealTimeOutcome> run_axis_in_real_time(const experiments::Request& request, const RealTimeOptions& options,
                                              const experiments::Progress& progress) {
  const auto cases = experiments::prepare_cases<TappingParams, Prepared>(
      request, [&options](const TappingParams& params) -> Result<Prepared> {
        runtime::ServoThreadParams servo = options.servo;
        servo.rate_Hz = params.servo.rate_Hz;
        if (auto error = check_servo_thread(servo)) return *std::move(error);
        if (auto error = experiments::refuse_supervised(params, "run --realtime without --device")) {
          return *std::move(error);
        }
        auto ensemble = TappingEnsemble::make(params);
        if (!ensemble) return ensemble.error();
        return Prepared{params, *std::move(ensemble), params.task.observation_s, servo};
      });
  if (!cases) return cases.error();
  if (auto error = refuse_long_runs(*cases)) return *std::move(error);

  std::unique_ptr<SharedPlant> plant;
  if (options.plant) {
    auto attached = attach_plant(*options.plant, *cases);
    if (!attached) return attached.error();
    plant = *std::move(attached);
  }

  std::optional<Outlets> outlets;
  if (options.log || options.look_on) outlets.emplace(*cases);
  if (options.look_on) {
    if (auto error = options.look_on(outlets->all())) return *std::move(error);
  }
  std::optional<telemetry::Recorder> log;
  if (options.log) {
    auto opened = open_log(request, options, *cases, *outlets);
    if (!opened) return opened.error();
    log.emplace(*std::move(opened));
  }

  std::size_t taps = 0;
  for (const auto& one : cases->all) taps += one.prepared.ensemble.size();
  std::size_t taps_done = 0;
  const auto tap_done = [&] { progress(static_cast<double>(++taps_done) / static_cast<double>(taps)); };
  const runtime::ProcessRights process;  // once for all taps
  const runtime::EndRequest never;
  const runtime::EndRequest& end = options.end != nullptr ? *options.end : never;
  std::vector<TappingRun> runs;
  KeptTime kept;
  for (std::size_t i = 0; i < cases->all.size() && !end.asked(); ++i) {
    auto done =
        run_taps(cases->all[i], plant.get(), outlets ? outlets->all()[i] : runtime::RealTimeStreams{}, end, tap_done);
    if (!done) {
      if (log) (void)close_log(*log, *options.log);  // it shows how it came to that
      return done.error();
    }
    kept.all.add(done->servo);
    if (!done->run) break;
    runs.push_back(*std::move(done->run));
    kept.runs.push_back(std::move(done->servo));
  }
  if (log) kept.log = close_log(*log, *options.log);
  if (taps_done < taps) kept.interrupted = Interrupted{.taps = taps_done, .of = taps};

  const report::Table table = experiments::tapping_table(runs);
  const std::string verdict = experiments::tapping_verdict(runs);
  std::vector<report::Figure> figures;
  if (!runs.empty()) figures = experiments::tapping_figures(runs);
  figures.push_back(timing_figure(kept.all));
  const report::Page page = experiments::tapping_page(request, verdict, table, figures);
  return real_time_outcome(request, cases->first_configuration, options.plant,
                           {.verdict = verdict,
                            .table = table,
                            .json = experiments::tapping_json(request, runs),
                            .page = page,
                            .figures = std::move(figures)},
                           std::move(kept));
}

}  // namespace

Result<RealTimeOutcome> run_in_real_time(const experiments::Request& request, const RealTimeOptions& options,
                                         const experiments::Progress& progress) {
  const auto experiment = experiments::choose_experiment(request.document);
  if (!experiment) return experiment.error();
  const std::string_view kind = (*experiment)->kind();
  if (kind == "tapping") return run_axis_in_real_time(request, options, progress);
  if (kind == "arm-tapping") return run_arms_in_real_time(request, options, progress);
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "task.kind",
               .message = "'" + std::string(kind) +
                          "' has no form in real time: run it in virtual time, without --realtime, or write tapping or "
                          "arm-tapping",
               .place = {}};
}

}  // namespace tactus::real_time
