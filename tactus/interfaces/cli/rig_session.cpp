// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/quiet_thread.hpp>
#include <tactus/interfaces/cli/rig_drive.hpp>
#include <tactus/interfaces/cli/rig_report.hpp>
#include <tactus/interfaces/cli/rig_run.hpp>
#include <tactus/interfaces/cli/rig_session.hpp>
#include <tactus/interfaces/cli/rig_sides.hpp>
#include <tactus/runtime/servo/site_log.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace tactus::cli {

using control::SiteRole;
using devices::Rig;
using devices::RigLoop;
using devices::RigSide;

namespace {

using Servo = runtime::ServoThread<RigLoop>;
using SiteReader = runtime::JointStreams::Site::Reader;
using JointReader = runtime::JointStreams::Joint::Reader;

/// Emulated motors are ordinary threads: they answer late on a busy computer, which is no fault of the pair.
constexpr double rehearsed_reply_s = 0.05, rehearsed_watchdog_s = 1.0;

Check relax(configuration::Document& document, bool arms) {
  const std::string section = arms ? "rig.supervision." : "control.supervision.";
  for (const char* key : {"longest_stall_s=0.5", "watchdog.timeout_s=0.5", "overload.missed_share=0.9"}) {
    if (Check error = document.set(section + key)) return error;
  }
  return std::nullopt;
}

}  // namespace

struct RigSession::State {
  Settings settings;
  experiments::Request request;
  std::optional<Rig> rig;
  std::optional<RigDrive> found;
  std::vector<const RigSide*> sides;
  std::vector<runtime::StreamedJoint> joints;
  runtime::SiteExchange exchange;
  // In this order, so that they end in the other: emulated motors, links and devices, streams, the servo thread.
  std::optional<EmulatedRig> emulated;
  std::array<std::optional<DrivenSide>, 2> driven;
  std::unique_ptr<runtime::JointStreams> streams;
  std::optional<runtime::SiteLog> log;
  std::unique_ptr<Servo> servo;
  std::thread watcher;  ///< takes the seconds
  std::atomic<bool> ending{false};

  mutable std::mutex mutex;  ///< of all that follows, and of the producer's side of `exchange.words`
  bool stopped = false;
  std::optional<devices::RigSecond> second;
  std::string problems_at_end;
  Summary summary;
  Sample sample;
  std::optional<SiteReader> leader, follower;
  std::vector<JointReader> leader_joints, follower_joints;

  Check open();
  Check run();
  void watch();
  void take_newest();
  [[nodiscard]] std::string problems() const;
};

Check RigSession::State::open() {
  auto loaded = load_experiment({.file = settings.experiment.file, .with = settings.experiment.with, .set = {}});
  if (!loaded) return loaded.error();
  const auto kind = loaded->text_at("task.kind");
  if (!kind || !drives_a_rig(*kind)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "task.kind",
                 .message =
                     "only an experiment of the kind tapping or arm-tapping drives a rig: name one, for instance "
                     "examples/rigs/joints.toml",
                 .place = settings.experiment.file};
  }
  const bool arms = experiments::is_of_arms(*loaded);
  if (settings.rehearsal) {
    if (Check error = relax(*loaded, arms)) return error;
  }
  auto document = with_set(*std::move(loaded), settings.experiment.set);
  if (!document) return document.error();
  request = {.document = *std::move(document),
             .variations = {},
             .name = experiment_name(settings.experiment.file),
             .command = {}};
  const auto [file, name] = parts_of_rig(settings.rig);
  auto read = Rig::load(file);
  if (!read) return read.error();
  rig.emplace(*std::move(read));
  const auto pair = pair_of_rig(*rig, name, {});
  if (!pair) return pair.error();
  const RigLoop::Params loop{};
  auto made = arms ? as_two_arms(request, *rig, **pair, loop, {}) : joint_by_joint(request, **pair, loop, {});
  if (!made) return made.error();
  found.emplace(*std::move(made));
  for (RigSide* side : {&*found->pair.leader, &*found->pair.follower}) {
    if (!settings.rehearsal && !devices::has_watchdog(side->bus.kind)) {
      return rig->locate({.code = ErrorCode::inconsistent,
                          .parameter = join(side->path, "bus"),
                          .message =
                              "these motors do not release their force by themselves when a program ends, so they "
                              "need the guard process of the command: use `tactus run --realtime --device`",
                          .place = {}});
    }
    sides.push_back(side);
  }
  joints = streamed_joints(*sides.front());
  return std::nullopt;
}

Check RigSession::State::run() {
  if (settings.rehearsal) {
    auto started =
        EmulatedRig::start(*rig, found->pair, std::nullopt, found->arms ? &*found->arms : nullptr, *settings.rehearsal);
    if (!started) return started.error();
    emulated.emplace(*std::move(started));
    found->about["tactus"]["motors"] = "emulated";
    for (RigSide* side : {&*found->pair.leader, &*found->pair.follower}) {
      side->bus.reply_timeout_s = std::max(side->bus.reply_timeout_s, rehearsed_reply_s);
      side->bus.watchdog_s = std::max(side->bus.watchdog_s, rehearsed_watchdog_s);
    }
  }
  std::string wrong;
  const Check unclean = refuse_unclean(*rig, sides, [&wrong](const std::string& line) { wrong += line; });
  if (unclean && wrong.empty()) return unclean;
  if (unclean) {
    constexpr std::string_view prefix = "tactus: ";
    std::string message = wrong.starts_with(prefix) ? wrong.substr(prefix.size()) : wrong;
    while (message.ends_with('\n')) message.pop_back();
    return Error{.code = ErrorCode::failed, .parameter = {}, .message = std::move(message), .place = {}};
  }
  for (std::size_t side = 0; side < sides.size(); ++side) {
    auto made = drive(*rig, *sides[side], emulated.has_value());
    if (!made) return made.error();
    driven[side].emplace(*std::move(made));
  }
  exchange.allow(found->settable);
  auto loop = found->loop(exchange, *driven[0]->device, *driven[1]->device);
  if (!loop) return request.document.locate(loop.error());
  streams = std::make_unique<runtime::JointStreams>(joints);
  leader.emplace(streams->site(SiteRole::master).watch());
  follower.emplace(streams->site(SiteRole::slave).watch());
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    leader_joints.push_back(streams->joint(SiteRole::master, joint).watch());
    follower_joints.push_back(streams->joint(SiteRole::slave, joint).watch());
  }
  sample.leader_joints.resize(joints.size());
  sample.follower_joints.resize(joints.size());
  loop->leave_in(*streams);
  if (!settings.folder.empty()) {
    auto created =
        runtime::SiteLog::create(settings.folder, *streams, about_rig(*found, request.name, joints, std::nullopt));
    if (!created) return created.error();
    log.emplace(*std::move(created));
  }
  runtime::ServoThreadParams params;
  params.rate_Hz = found->rate_Hz;
  params.priority = settings.priority;
  auto started = Servo::start(params, *std::move(loop));
  if (!started) return started.error();
  servo = *std::move(started);
  auto thread = start_quiet_thread([this] { watch(); });
  if (!thread) return thread.error();
  watcher = *std::move(thread);
  return std::nullopt;
}

/// The seconds come on a ring of which one thread takes.
void RigSession::State::watch() {
  constexpr std::chrono::milliseconds between_looks(20);
  while (!ending.load()) {
    while (const auto next = servo->step().next_second()) {
      const std::scoped_lock lock(mutex);
      second = next;
    }
    std::this_thread::sleep_for(between_looks);
  }
}

/// Both sites and all joints of one control cycle: the leader's site is pushed first.
void RigSession::State::take_newest() {
  runtime::JointStreams::Site::Entry site;
  bool any = false;
  while (leader->next(site)) {
    sample.leader = site.record;
    sample.cycle = site.record.tick;
    sample.time_ns = static_cast<std::int64_t>(site.time_ns) + streams->origin_ns();
    any = true;
  }
  if (!any) return;
  // The servo thread is within this cycle at the latest: a few microseconds.
  constexpr int most_looks = 10'000;
  const auto catch_up = [this](auto& reader, auto& record, auto entry) {
    for (int look = 0; look < most_looks && record.tick < sample.cycle; ++look) {
      if (reader.next(entry)) {
        record = entry.record;
      } else {
        std::this_thread::yield();
      }
    }
  };
  catch_up(*follower, sample.follower, site);
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    catch_up(leader_joints[joint], sample.leader_joints[joint], runtime::JointStreams::Joint::Entry{});
    catch_up(follower_joints[joint], sample.follower_joints[joint], runtime::JointStreams::Joint::Entry{});
  }
}

/// Why drivers ended by themselves, or cannot drive their motors at present.
std::string RigSession::State::problems() const {
  std::string text;
  for (std::size_t side = 0; side < sides.size(); ++side) {
    if (!driven[side] || !driven[side]->link) continue;
    if (const Check problem = driven[side]->link->problem()) {
      text += (text.empty() ? "" : "; ") + sides[side]->path + ": " + describe(*problem);
    }
  }
  return text;
}

RigSession::RigSession(std::unique_ptr<State> state) : state_(std::move(state)) {}

RigSession::~RigSession() { stop(); }

Result<std::unique_ptr<RigSession>> RigSession::start(const Settings& settings) {
  auto state = std::make_unique<State>();
  state->settings = settings;
  if (Check error = state->open()) return *std::move(error);
  std::unique_ptr<RigSession> session(new RigSession(std::move(state)));
  if (Check error = session->state_->run()) return *std::move(error);
  return session;
}

const std::vector<runtime::StreamedJoint>& RigSession::joints() const noexcept { return state_->joints; }

bool RigSession::running() const {
  const std::scoped_lock lock(state_->mutex);
  return !state_->stopped && !state_->servo->ended();
}

Check RigSession::press(std::string_view line) {
  const std::scoped_lock lock(state_->mutex);
  const auto failed = [](const char* why) {
    return Error{.code = ErrorCode::failed, .parameter = {}, .message = why, .place = {}};
  };
  if (state_->stopped || state_->servo->ended()) return failed("the teleoperator has ended: start it again");
  const auto asked = state_->exchange.ask(line, control::SiteRole::master, runtime::RequestSource::operator_input);
  if (!asked) return asked.error();
  return std::nullopt;
}

RigSession::Sample RigSession::newest() {
  const std::scoped_lock lock(state_->mutex);
  state_->take_newest();
  return state_->sample;
}

std::string RigSession::line() const {
  const std::scoped_lock lock(state_->mutex);
  std::string text = state_->second ? line_of(*state_->second, state_->found->pair) : std::string();
  while (text.ends_with('\n')) text.pop_back();
  const std::string problems = state_->stopped ? state_->problems_at_end : state_->problems();
  return problems.empty() ? text : text + (text.empty() ? "" : "; ") + problems;
}

RigSession::Summary RigSession::summary() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->summary;
}

Check RigSession::stop() {
  State& state = *state_;
  {
    const std::scoped_lock lock(state.mutex);
    if (std::exchange(state.stopped, true)) return std::nullopt;
  }
  state.exchange.end.ask();
  Check error;
  if (state.servo) {
    const runtime::ServoReport report = state.servo->finish();
    state.ending.store(true);
    if (state.watcher.joinable()) state.watcher.join();
    const std::scoped_lock lock(state.mutex);
    state.take_newest();
    state.summary.totals = state.servo->step().totals();
    state.summary.servo = report;
    state.problems_at_end = state.problems();
  }
  for (auto& side : state.driven) {
    if (side) side->link->stop();
  }
  if (state.log) {
    error = state.log->close();
    const std::scoped_lock lock(state.mutex);
    state.summary.log_dropped = state.log->dropped();
  }
  std::string powered;
  const Check on = switch_off(state.driven, state.sides, [&powered](const std::string& line) { powered += line; });
  if (on) {
    while (powered.ends_with('\n')) powered.pop_back();
    return Error{.code = ErrorCode::failed, .parameter = {}, .message = powered, .place = {}};
  }
  return error;
}

}  // namespace tactus::cli
