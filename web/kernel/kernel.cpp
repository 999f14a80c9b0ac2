// SPDX-License-Identifier: Apache-2.0
#include "kernel.hpp"

#include <tactus/data/configuration/assign.hpp>
#include <tactus/interfaces/live/axis_loop.hpp>
#include <tactus/interfaces/live/contact_judge.hpp>
#include <tactus/interfaces/live/hand.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace {

using tactus::Check;
using tactus::Error;
using tactus::experiments::TappingEnsemble;
using tactus::experiments::TappingParams;
using Record = tactus::simulation::Teleoperator::Record;

constexpr std::size_t sides = 2;
constexpr int most_rows = 1024;
constexpr std::size_t shared_numbers = 2;
constexpr std::size_t side_numbers = 10;
constexpr std::size_t row_numbers = shared_numbers + sides * side_numbers;
constexpr std::size_t record_numbers = 16;

struct Side {
  TappingParams wanted;
  std::optional<tactus::simulation::Teleoperator::Params> running;  ///< what the loop was made of
  std::unique_ptr<tactus::live::Loop> loop;
  std::optional<tactus::live::ContactJudge> judge;
  tactus::live::LoopTick tick;
  bool stopped = false;
};

struct Kernel {
  std::array<char, 4096> text{};
  std::array<Side, sides> side;
  std::optional<tactus::live::Hand> hand;
  std::int64_t cycles = 0;
  std::vector<double> rows = std::vector<double>(row_numbers * most_rows);
  std::optional<TappingEnsemble> taps;
  std::vector<double> trace;
  std::array<double, 5> result{};
};

Kernel& kernel() {
  static Kernel one;
  return one;
}

int fail(const std::string& parameter, const std::string& message) {
  auto& text = kernel().text;
  const std::string sentence = parameter + ": " + message;
  const std::size_t length = std::min(sentence.size(), text.size() - 1);
  std::copy_n(sentence.begin(), length, text.begin());
  text[length] = '\0';
  return -1;
}
int fail(const Error& error) { return fail(error.parameter, error.message); }

/// What `text` is, for a key that holds what `binding` holds.
tactus::configuration::Value value_of(const std::string& text, const tactus::Binding& binding) {
  if (std::holds_alternative<bool*>(binding.target) && (text == "true" || text == "false")) return text == "true";
  if (std::holds_alternative<std::string*>(binding.target)) return text;
  std::int64_t whole = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (parsed.ec == std::errc() && parsed.ptr == text.data() + text.size()) return whole;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (!text.empty() && *end == '\0') return number;
  return text;
}

Check set(TappingParams& params, std::string_view assignment) {
  const std::size_t middle = assignment.find('=');
  tactus::configuration::Entry entry{.path = std::string(assignment.substr(0, middle)),
                                     .value = {},
                                     .key_position = {},
                                     .value_position = {},
                                     .assignment = {},
                                     .typed = {},
                                     .file = {}};
  const std::vector<tactus::Binding> bindings = tactus::bind(params);
  const auto binding = std::find_if(bindings.begin(), bindings.end(),
                                    [&entry](const auto& candidate) { return candidate.path == entry.path; });
  if (binding == bindings.end() || middle == std::string_view::npos) {
    return tactus::configuration::unknown_key(entry, bindings);
  }
  entry.value = value_of(std::string(assignment.substr(middle + 1)), *binding);
  return tactus::configuration::assign(entry, *binding);
}

/// The parameters of a loop: the wall is where the live page has it (`live::Settings`), and the controller's model has
/// the fixed errors of the experiment's taps.
tactus::simulation::Teleoperator::Params of_loop(const TappingParams& wanted) {
  tactus::simulation::Teleoperator::Params params = wanted;
  params.environment.position_m = tactus::live::loop_wall_m * params.control.position_scale;
  params.control.model = tactus::experiments::mismatched(params.control.model, wanted.task.mismatch);
  return params;
}

Check make_loop(Side& side, double start_m) {
  const auto params = of_loop(side.wanted);
  auto made = tactus::live::AxisLoop::make(params, start_m);
  if (!made) return made.error();
  const auto judge = tactus::live::ContactJudge::make(tactus::Seconds{(*made)->tick_s()});
  if (!judge) return judge.error();
  side.loop = *std::move(made);
  side.running = params;
  side.judge = *judge;
  side.tick = {};
  side.stopped = false;
  return std::nullopt;
}

Check apply(Side& side) {
  if (!side.loop) return make_loop(side, 0.0);
  const auto params = of_loop(side.wanted);
  auto change = tactus::live::AxisLoop::change(*side.running, params, 0.0);
  if (!change) return change.error();
  if (!change->made) return std::nullopt;
  if (!change->goes_on) return make_loop(side, 0.0);
  side.loop->exchange(*change->made);
  side.running = params;
  side.judge->judge_anew();
  return std::nullopt;
}

void write(const Record& record, double* out) {
  const std::array<double, record_numbers> numbers{record.time_s,
                                                   record.master_position_m,
                                                   record.induced_position_m,
                                                   record.command_m,
                                                   record.slave_position_m,
                                                   record.tip_position_m,
                                                   record.displayed_force_N,
                                                   record.handle_force_N,
                                                   record.hand_force_N,
                                                   record.sent_force_N,
                                                   record.contact_force_N,
                                                   record.peak_contact_force_N,
                                                   record.touched ? 1.0 : 0.0,
                                                   record.touched_at_s,
                                                   record.estimated_grip,
                                                   record.estimated_grip_deviation};
  std::copy(numbers.begin(), numbers.end(), out);
}

void step(Side& side, double path_m, double path_at_next_cycle_m, double* out) {
  if (!side.stopped) {
    side.loop->step({path_m, 0.0, 0.0}, {path_at_next_cycle_m, 0.0, 0.0}, 1.0, side.tick);
    side.stopped = !side.loop->good();
    side.judge->step(side.tick.record.contact_force_N, side.tick.record.touched);
  }
  const Record& record = side.tick.record;
  const std::array<double, side_numbers> numbers{record.master_position_m,
                                                 record.induced_position_m,
                                                 record.command_m,
                                                 record.tip_position_m,
                                                 record.displayed_force_N,
                                                 record.contact_force_N,
                                                 record.peak_contact_force_N,
                                                 static_cast<double>(side.judge->verdict()),
                                                 side.judge->settling_time_s(),
                                                 side.stopped ? 1.0 : 0.0};
  std::copy(numbers.begin(), numbers.end(), out);
}

}  // namespace

char* tactus_text() { return kernel().text.data(); }

int tactus_set(int side) {
  const std::string assignment = kernel().text.data();
  const Check error = set(kernel().side[side == 0 ? 0 : 1].wanted, assignment);
  return error ? fail(*error) : 0;
}

int tactus_apply(int side) {
  const Check error = apply(kernel().side[side == 0 ? 0 : 1]);
  return error ? fail(*error) : 0;
}

int tactus_restart(double start_m) {
  for (Side& side : kernel().side) {
    if (const Check error = make_loop(side, start_m)) return fail(*error);
  }
  const auto hand = tactus::live::Hand::make(tactus::Seconds{kernel().side[0].loop->tick_s()});
  if (!hand) return fail(hand.error());
  kernel().hand = *hand;
  kernel().cycles = 0;
  return 0;
}

void tactus_aim(double position_m) {
  if (kernel().hand) kernel().hand->aim(position_m);
}

void tactus_tap() {
  if (kernel().hand) kernel().hand->begin({.wall_m = tactus::live::loop_wall_m});
}

double tactus_tap_start_m() { return tactus::live::ScriptedTap{.wall_m = tactus::live::loop_wall_m}.start_m(); }

double tactus_cycle_s() { return 1.0 / kernel().side[0].wanted.servo.rate_Hz; }

int tactus_row() { return static_cast<int>(row_numbers); }
int tactus_most_rows() { return most_rows; }

const double* tactus_step(int cycles) {
  Kernel& all = kernel();
  double* row = all.rows.data();
  if (!all.hand) return row;
  for (int i = 0; i < std::min(cycles, most_rows); ++i, row += row_numbers) {
    const auto [path_m, path_at_next_cycle_m] = all.hand->step();
    row[0] = static_cast<double>(all.cycles++) * tactus_cycle_s();
    row[1] = path_m;
    for (std::size_t s = 0; s < sides; ++s) {
      step(all.side[s], path_m, path_at_next_cycle_m, row + shared_numbers + s * side_numbers);
    }
  }
  return all.rows.data();
}

int tactus_taps() {
  auto made = TappingEnsemble::make(kernel().side[0].wanted);
  if (!made) return fail(made.error());
  kernel().taps = *std::move(made);
  return static_cast<int>(kernel().taps->size());
}

int tactus_run_tap(int tap) {
  Kernel& all = kernel();
  if (!all.taps || tap < 0 || static_cast<std::size_t>(tap) >= all.taps->size()) {
    return fail("tap", "there is no such tap: call tactus_taps first, and count from 0");
  }
  std::vector<Record> trace;
  const auto result = all.taps->run(static_cast<std::size_t>(tap), &trace);
  all.trace.resize(trace.size() * record_numbers);
  for (std::size_t i = 0; i < trace.size(); ++i) write(trace[i], all.trace.data() + i * record_numbers);
  all.result = {static_cast<double>(result.metrics.contacts), result.metrics.settled ? 1.0 : 0.0,
                result.metrics.settling_time_s, result.metrics.peak_force_N, result.metrics.residual_rms_N};
  return static_cast<int>(trace.size());
}

const double* tactus_trace() { return kernel().trace.data(); }
const double* tactus_result() { return kernel().result.data(); }
