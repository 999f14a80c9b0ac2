// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/cdr.hpp>
#include <tactus/data/telemetry/description.hpp>
#include <tactus/interfaces/live/arm_loop.hpp>
#include <tactus/interfaces/live/live_view.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::live {

namespace {

constexpr double state_every_s = 1.0 / 60.0;
/// How much later than the hand a follower's tool is at the wall, at the most.
constexpr double arms_follow_s = 0.15;
/// A tenth of a second at 5 kHz, ten times what a call usually finds.
constexpr std::size_t most_ticks_a_call = 512;

Payload shared(std::string bytes) { return std::make_shared<const std::string>(std::move(bytes)); }

Status problem(const Error& error) { return {StatusLevel::error, describe(error)}; }

Status nonsense(std::string_view topic, const char* expected) {
  return {StatusLevel::error, std::string(topic) + ": expected JSON like " + expected};
}

/// An object, or null for all else.
nlohmann::json object_in(std::string_view bytes) {
  constexpr std::size_t longest = 1024;
  if (bytes.size() > longest) return nullptr;
  nlohmann::json value = nlohmann::json::parse(bytes, nullptr, false);
  return value.is_object() ? value : nlohmann::json(nullptr);
}

nlohmann::json json_of(const ParameterValue& value) {
  return std::visit([](const auto& one) { return nlohmann::json(one); }, value);
}

const char* word_of(LiveVerdict verdict) {
  constexpr std::array words{"free", "contact", "settled", "rings"};
  return words[static_cast<std::size_t>(verdict)];
}

/// Where a message says that a hand is: a number, or one for each direction that the devices have.
std::optional<HandPoint> point_in(const nlohmann::json& position, const HandPoint& workspace_m) {
  HandPoint point{};
  if (position.is_number()) {
    point[0] = position.get<double>();
    return point;
  }
  if (!position.is_array() || position.size() != point.size() || workspace_m[1] == 0.0) return std::nullopt;
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (!position[i].is_number()) return std::nullopt;
    point[i] = position[i].get<double>();
  }
  return point;
}

}  // namespace

Result<LiveView::Params> LiveView::params_of(const Settings& settings) {
  Params all;
  for (std::size_t i = 0; i < loops; ++i) {
    auto params = settings.of_loop(i);
    if (!params) return params.error();
    all[i] = *std::move(params);
  }
  return all;
}

Result<std::unique_ptr<LiveView>> LiveView::make(const Settings& settings, const Options& options) {
  auto params = params_of(settings);
  if (!params) return params.error();
  Engine::Setup setup{.loop = {}, .runs = {settings.runs(0), settings.runs(1)}};
  for (std::size_t i = 0; i < loops; ++i) {
    auto made = make_loop((*params)[i], 0.0);
    if (!made) return made.error();
    setup.loop[i] = *std::move(made);
  }
  const Seconds tick{setup.loop[0]->tick_s()};
  auto judge = ContactJudge::make(tick);
  if (!judge) return judge.error();
  const auto energy = VibrationEnergy::make(tick);
  if (!energy) return energy.error();
  auto engine = Engine::make(std::move(setup));
  if (!engine) return engine.error();
  return std::unique_ptr<LiveView>(
      new LiveView(settings, options, *std::move(params), *std::move(engine), *judge, *energy));
}

LiveView::LiveView(const Settings& settings, const Options& options, Params params, std::unique_ptr<Engine> engine,
                   const ContactJudge& judge, const VibrationEnergy& energy)
    : settings_(settings),
      initial_(settings),
      options_(options),
      params_(std::move(params)),
      engine_(std::move(engine)),
      topics_of_loop_(0),
      history_(settings.parameters()) {
  const std::string package = "tactus_msgs/msg/";
  for (const char* loop : loop_names) {
    const std::string prefix = std::string("/") + loop + "/";
    // In the order of `TopicOf`.
    topics_.push_back({prefix + "block", package + "LiveBlock", live_block_definition()});
    topics_.push_back({prefix + "hand_force", package + "HandForce", hand_force_definition()});
    topics_.push_back({prefix + "state", package + "LiveState", live_state_definition()});
    topics_.push_back({prefix + "teleoperator", package + "TeleoperatorRecord",
                       telemetry::ros2msg(telemetry::columns_of<Engine::Record>())});
    if (settings_.arms() != nullptr) {
      topics_.push_back({prefix + "arms", package + "LiveArms", live_arms_definition()});
    }
    watched_.push_back({.block = BlockBuilder(engine_->tick_s()), .judge = judge, .energy = energy, .state = {}});
  }
  topics_of_loop_ = topics_.size() / loops;
}

std::map<std::string, std::string> LiveView::metadata() const {
  constexpr std::array kinds{"number", "choice", "flag"};
  nlohmann::json list = nlohmann::json::array();
  for (const ParameterDescription& description : settings_.descriptions()) {
    nlohmann::json item{{"name", description.name},
                        {"label", description.label},
                        {"unit", description.unit.symbol},
                        {"kind", kinds[static_cast<std::size_t>(description.kind)]},
                        {"logarithmic", description.logarithmic},
                        {"initial", json_of(description.initial)},
                        {"tunable", options_.allow_tuning}};
    if (description.kind == ParameterDescription::Kind::number) {
      item["minimum"] = description.bounds.lower;
      item["maximum"] = description.bounds.upper;
    }
    if (description.kind == ParameterDescription::Kind::choice) {
      item["choices"] = description.choices;
      item["explanations"] = description.explanations;
    }
    list.push_back(std::move(item));
  }
  std::map<std::string, std::string> about{{"tactus.parameters", list.dump()},
                                           {"tactus.version", std::string(version())},
                                           {"tactus.experiment", options_.experiment}};
  if (settings_.arms() != nullptr) about["tactus.arms"] = arms_as_json(*settings_.arms());
  return about;
}

std::vector<Status> LiveView::set_parameters(const std::vector<Parameter>& wanted) {
  if (!options_.allow_tuning) {
    return {{StatusLevel::error, wanted.front().name.substr(0, 80) +
                                     ": parameters cannot be changed here: start with `tactus serve --allow-tuning`"}};
  }
  std::vector<Status> refused;
  Settings tried = settings_;
  for (const Parameter& parameter : wanted) {
    // One after the other, so that one that is refused does not take the others with it.
    Settings with_this = tried;
    auto error = with_this.set(parameter);
    if (!error) {
      if (const auto params = params_of(with_this); !params) error = params.error();
    }
    if (error) {
      refused.push_back(problem(*error));
    } else {
      tried = std::move(with_this);
    }
  }
  if (const auto error = apply(tried)) refused.push_back(problem(*error));
  return refused;
}

Check LiveView::apply(const Settings& settings) {
  auto params = params_of(settings);
  if (!params) return params.error();
  auto change = std::make_unique<Change>();
  for (std::size_t i = 0; i < loops; ++i) {
    // What starts over begins before the wall, wherever the hand is by now; the hand takes it along smoothly.
    const double workspace_m = settings.workspace_m()[0];
    const double start_m = std::clamp(watched_[i].state.master_position_m, -workspace_m, 0.9 * Settings::wall_m);
    if (settings.runs(i) && !settings_.runs(i)) {
      auto made = make_loop((*params)[i], start_m);
      if (!made) return made.error();
      change->loop[i].made = *std::move(made);
    } else {
      auto changed = change_loop(params_[i], (*params)[i], start_m);
      if (!changed) return changed.error();
      change->loop[i] = *std::move(changed);
    }
  }
  for (std::size_t i = 0; i < loops; ++i) change->runs[i] = settings.runs(i);
  if (!engine_->change(std::move(change))) {
    return Error{.code = ErrorCode::failed, .parameter = {}, .message = "the loop is busy: try again", .place = {}};
  }
  settings_ = settings;
  params_ = *std::move(params);
  history_.set(settings_.parameters());
  return std::nullopt;
}

std::optional<Status> LiveView::receive(ClientId client, std::string_view topic, std::string_view encoding,
                                        std::string_view bytes) {
  const bool is_hand = topic == "/operator/hand";
  if (!is_hand && topic != "/operator/command") {
    return Status{StatusLevel::error, std::string(topic.substr(0, 80)) +
                                          ": nobody listens; there are /operator/hand and /operator/command"};
  }
  if (encoding != "json") return Status{StatusLevel::error, std::string(topic) + ": the encoding must be json"};
  return is_hand ? move_hand(client, bytes) : command(bytes);
}

std::optional<Status> LiveView::move_hand(ClientId client, std::string_view bytes) {
  const nlohmann::json message = object_in(bytes);
  const auto position = message.is_object() ? message.find("position_m") : message.end();
  const auto engaged = message.is_object() ? message.find("engaged") : message.end();
  const HandPoint workspace_m = settings_.workspace_m();
  const auto asked = position == message.end() ? std::nullopt : point_in(*position, workspace_m);
  if (!asked || engaged == message.end() || !engaged->is_boolean()) {
    return nonsense("/operator/hand", workspace_m[1] == 0.0 ? R"({"position_m": 0.005, "engaged": true})"
                                                            : R"({"position_m": [0.005, 0.0, 0.0], "engaged": true})");
  }
  if (holder_ && *holder_ != client) {
    return Status{StatusLevel::warning, "another client holds the handle; it is free when that client releases it"};
  }
  if (!engaged->get<bool>()) {
    if (holder_) leave(client);
    return std::nullopt;
  }
  holder_ = client;
  HandPoint target = *asked;
  for (std::size_t i = 0; i < target.size(); ++i) target[i] = std::clamp(target[i], -workspace_m[i], workspace_m[i]);
  if (!engine_->aim(target)) return Status{StatusLevel::warning, "the loop is busy: the hand was not moved"};
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (target[i] == (*asked)[i]) continue;
    return Status{StatusLevel::warning, "position_m = " + format_number((*asked)[i]) +
                                            " m is outside the workspace: it " +
                                            describe_bounds(between(-workspace_m[i], workspace_m[i]), units::metre)};
  }
  return std::nullopt;
}

std::optional<Status> LiveView::command(std::string_view bytes) {
  const nlohmann::json message = object_in(bytes);
  const auto word = message.is_object() ? message.find("command") : message.end();
  if (word == message.end() || (*word != "tap" && *word != "reset")) {
    return nonsense("/operator/command", R"({"command": "tap"} or {"command": "reset"})");
  }
  return start_over(*word == "tap" ? std::optional<ScriptedTap>(settings_.tap()) : std::nullopt);
}

std::optional<Status> LiveView::start_over(const std::optional<ScriptedTap>& tap) {
  const double start_m = tap ? tap->begin_m() : 0.0;
  auto change = std::make_unique<Change>();
  for (std::size_t i = 0; i < loops; ++i) {
    auto made = make_loop(params_[i], start_m);
    if (!made) return problem(made.error());
    change->loop[i].made = *std::move(made);
  }
  change->reset_hand = true;
  change->tap = tap;
  if (!engine_->change(std::move(change))) return Status{StatusLevel::warning, "the loop is busy: try again"};
  return std::nullopt;
}

void LiveView::leave(ClientId client) {
  if (holder_ != client) return;
  holder_.reset();
  // Where the loop has no room for this, it has not moved for long either.
  static_cast<void>(engine_->aim({}));
}

void LiveView::stand_alone() {
  // A loop that has no room for this now gets it with the next change.
  static_cast<void>(apply(initial_));
}

void LiveView::collect(const std::function<bool(std::size_t topic)>& is_wanted, const Publish& publish) {
  if (!ticks_) ticks_.emplace(engine_->watch());
  std::array<bool, loops> every_tick;
  for (std::size_t i = 0; i < loops; ++i) every_tick[i] = is_wanted(i * topics_of_loop_ + full_rate);
  EngineTick tick;
  // What the loops do while this runs waits for the next call: else a slow call would never end.
  for (std::size_t shown = 0; shown < most_ticks_a_call && ticks_->next(tick); ++shown) {
    lost_ticks_.store(ticks_->lost(), std::memory_order_relaxed);
    for (std::size_t i = 0; i < loops; ++i) {
      if (tick.ran[i]) show(i, tick.loop[i], every_tick[i], publish);
    }
  }
}

void LiveView::show(std::size_t loop, const LoopTick& tick, bool every_tick, const Publish& publish) {
  const auto state_ticks = static_cast<std::size_t>(std::max(1L, std::lround(state_every_s / engine_->tick_s())));
  Watched& watched = watched_[loop];
  const std::size_t first_topic = loop * topics_of_loop_;
  watch(loop, tick);
  if (every_tick) {
    const auto bytes = telemetry::to_cdr(tick.record);
    publish(first_topic + full_rate, tick.time_ns, shared(std::string(bytes.begin(), bytes.end())));
  }
  if (watched.block.add(tick)) {
    BlockBuilder::Block built = watched.block.take();
    publish(first_topic + block, built.time_ns, shared(std::move(built.live_block)));
    publish(first_topic + hand_force, built.time_ns, shared(std::move(built.hand_force)));
  }
  if (++watched.ticks_to_state < state_ticks) return;
  watched.ticks_to_state = 0;
  watched.state.dropped = lost_ticks();
  watched.state.verdict = tick.stopped ? "stopped" : word_of(watched.judge.verdict());
  watched.state.cause =
      tick.stopped ? "A safety gate latched or a device left its workspace; reset starts over." : watched.judge.cause();
  watched.state.advice = tick.stopped ? "" : advice(loop);
  watched.state.force_limit_N = force_limit_N(params_[loop]);
  publish(first_topic + state, tick.time_ns, shared(to_cdr(watched.state)));
  if (settings_.arms() != nullptr) {
    publish(first_topic + arms, tick.time_ns, shared(to_cdr(tick.arms, tick.record.time_s)));
  }
}

std::string LiveView::advice(std::size_t loop) const {
  const LiveVerdict verdict = watched_[loop].judge.verdict();
  if (verdict != LiveVerdict::settled && verdict != LiveVerdict::rings) return {};
  const std::optional<double>& speed_m_per_s = watched_[loop].touch_speed_m_per_s;
  if (!speed_m_per_s)
    return "It touched the wall, and that was before the change: release it and tap to try the loop as it is now.";
  const auto in_mm_per_s = [](double value) { return format_number(std::round(1e3 * value)) + " mm/s"; };
  const std::string touched = "You touched at " + in_mm_per_s(*speed_m_per_s);
  if (verdict == LiveVerdict::rings) return touched + ".";
  if (watched_[loop].rang) return touched + ". It rang before it came to rest.";
  const std::string button = in_mm_per_s(ScriptedTap::speed_m_per_s);
  if (*speed_m_per_s < ScriptedTap::speed_m_per_s - 0.5e-3) {
    return touched + ", too gently to try it; the button taps at " + button + ". Tap faster.";
  }
  return touched + (settings_.is_plain(loop) ? ". Now and then a plain loop comes to rest by chance: tap again."
                                             : ", no slower than the button.");
}

void LiveView::watch(std::size_t loop, const LoopTick& tick) {
  Watched& watched = watched_[loop];
  const Engine::Record& record = tick.record;
  LiveState& shown = watched.state;
  if (tick.run != watched.run) {
    watched.run = tick.run;
    watched.judge.reset();
    watched.energy.reset(record.master_position_m);
    history_.start_over(loop);
  }
  const double follows_s = settings_.arms() == nullptr ? 0.0 : arms_follow_s;
  const auto held = static_cast<double>(tick.number - watched.fastest_at) * engine_->tick_s();
  if (tick.hand_speed_m_per_s >= watched.fastest_m_per_s || held > follows_s) {
    watched.fastest_m_per_s = tick.hand_speed_m_per_s;
    watched.fastest_at = tick.number;
  }
  const bool changed = tick.changes != watched.changes;
  watched.changes = tick.changes;
  if (changed) watched.judge.judge_anew();
  const bool goes_on = watched.judge.verdict() != LiveVerdict::free;
  watched.judge.step(record.contact_force_N, record.touched);
  watched.energy.step(record.displayed_force_N, record.master_position_m);
  if (watched.judge.has_begun()) {
    watched.energy.begin();
    watched.rang = false;
    watched.touch_speed_m_per_s = goes_on ? std::nullopt : std::optional(watched.fastest_m_per_s);
  }
  watched.rang = watched.rang || watched.judge.verdict() == LiveVerdict::rings;
  shown.vibration_energy_J = watched.energy.energy_J();
  history_.watch(loop,
                 {.time_s = record.time_s,
                  .contact_force_N = record.contact_force_N,
                  .vibration_energy_J = shown.vibration_energy_J},
                 watched.judge);
  shown.time_s = record.time_s;
  shown.hand_position_m = tick.hand_position_m;
  shown.master_position_m = record.master_position_m;
  shown.slave_position_m = record.slave_position_m;
  shown.wall_position_m = tick.wall_position_m;
  shown.slave_force_N = record.contact_force_N;
  shown.displayed_force_N = record.displayed_force_N;
  shown.estimated_grip = record.estimated_grip;
  shown.estimated_grip_deviation = record.estimated_grip_deviation;
  shown.in_contact = watched.judge.in_contact();
  shown.real_time_ratio = tick.real_time_ratio;
}

}  // namespace tactus::live
